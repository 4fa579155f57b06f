// Edges without stairs: a blur along the edge where brightness changes between neighbours (T. Lottes, FXAA, 2009).
uniform sampler2D picture;
uniform vec2 size;

const vec3 BRIGHT = vec3(0.299, 0.587, 0.114);

out vec4 smoothed;

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy), last = ivec2(size) - 1;
    vec3 middle = texelFetch(picture, here, 0).rgb;
    float nw = dot(texelFetch(picture, clamp(here + ivec2(-1, 1), ivec2(0), last), 0).rgb, BRIGHT);
    float ne = dot(texelFetch(picture, clamp(here + ivec2(1, 1), ivec2(0), last), 0).rgb, BRIGHT);
    float sw = dot(texelFetch(picture, clamp(here + ivec2(-1, -1), ivec2(0), last), 0).rgb, BRIGHT);
    float se = dot(texelFetch(picture, clamp(here + ivec2(1, -1), ivec2(0), last), 0).rgb, BRIGHT);
    float own = dot(middle, BRIGHT);
    float low = min(own, min(min(nw, ne), min(sw, se))), high = max(own, max(max(nw, ne), max(sw, se)));
    smoothed = vec4(middle, 1.0);
    if (high - low > max(0.04, 0.125 * high)) {
        vec2 way = vec2(-((nw + ne) - (sw + se)), (nw + sw) - (ne + se));
        float shortest = 1.0 / (min(abs(way.x), abs(way.y)) + max((nw + ne + sw + se) * 0.03125, 0.0078125));
        way = clamp(way * shortest, -8.0, 8.0) / size;
        vec2 uv = gl_FragCoord.xy / size;
        vec3 near = 0.5 * (texture(picture, uv - way / 6.0).rgb + texture(picture, uv + way / 6.0).rgb);
        vec3 far = 0.5 * near + 0.25 * (texture(picture, uv - way / 2.0).rgb + texture(picture, uv + way / 2.0).rgb);
        float bright = dot(far, BRIGHT);
        smoothed.rgb = bright < low || bright > high ? near : far;
    }
}
