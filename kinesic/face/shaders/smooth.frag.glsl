// Edges without stairs: a blur along the edge (T. Lottes, FXAA, 2009).
uniform sampler2D picture;
uniform vec2 pixel;  // in texture coordinates

const vec3 BRIGHT = vec3(0.299, 0.587, 0.114);

in vec2 uv;

out vec4 smoothed;

vec3 colour(vec2 at) { return textureLod(picture, at, 0.0).rgb; }

void main() {
    float nw = dot(colour(uv + vec2(-pixel.x, pixel.y)), BRIGHT), ne = dot(colour(uv + pixel), BRIGHT);
    float sw = dot(colour(uv - pixel), BRIGHT), se = dot(colour(uv + vec2(pixel.x, -pixel.y)), BRIGHT);
    float own = dot(colour(uv), BRIGHT);
    float low = min(own, min(min(nw, ne), min(sw, se))), high = max(own, max(max(nw, ne), max(sw, se)));
    vec2 way = vec2(-((nw + ne) - (sw + se)), (nw + sw) - (ne + se));
    float shortest = 1.0 / (min(abs(way.x), abs(way.y)) + max((nw + ne + sw + se) * 0.03125, 0.0078125));
    way = clamp(way * shortest, -8.0, 8.0) * pixel;
    vec3 near = 0.5 * (colour(uv - way / 6.0) + colour(uv + way / 6.0));
    vec3 far = 0.5 * near + 0.25 * (colour(uv - way / 2.0) + colour(uv + way / 2.0));
    float found = dot(far, BRIGHT);
    smoothed = vec4(found < low || found > high ? near : far, 1.0);
}
