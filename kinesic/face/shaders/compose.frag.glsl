// The picture: light times colour, as the screen wants it.
uniform sampler2D diffuse;
uniform sampler2D colour;

in vec2 uv;

out vec4 picture;

// sRGB without a power (exact to 0.003).
vec3 encoded(vec3 light) {
    vec3 a = sqrt(light), b = sqrt(a), c = sqrt(b);
    return 0.585122381 * a + 0.783140355 * b - 0.368262736 * c;
}

void main() {
    vec4 lit = textureLod(diffuse, uv, 0.0);
    vec3 root = textureLod(colour, uv, 0.0).rgb, light = lit.rgb * root * root + lit.a;
    light = light * (1.0 + light * 0.12) / (1.0 + light * 0.35);
    picture = vec4(encoded(clamp(light, 0.0, 1.0)), 1.0);
}
