// The picture: light times colour over a plain background, as the screen wants it.
uniform sampler2D position;
uniform sampler2D diffuse;
uniform sampler2D colour;
uniform vec2 size;
uniform vec3 backdrop;

out vec4 picture;

// sRGB without a power (exact to 0.003).
vec3 encoded(vec3 light) {
    vec3 a = sqrt(light), b = sqrt(a), c = sqrt(b);
    return 0.585122381 * a + 0.783140355 * b - 0.368262736 * c;
}

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    vec2 from = gl_FragCoord.xy / size - vec2(0.5, 0.55);
    vec3 light = backdrop * (1.25 - 1.3 * dot(from, from));
    if (texelFetch(position, here, 0).w > 0.0) {
        vec4 lit = texelFetch(diffuse, here, 0);
        light = lit.rgb * texelFetch(colour, here, 0).rgb + lit.a;
    }
    light = light * (1.0 + light * 0.12) / (1.0 + light * 0.35);
    picture = vec4(encoded(clamp(light, 0.0, 1.0)), 1.0);
}
