// Edges without stairs: a blur along the edge (T. Lottes, FXAA, 2009).
uniform sampler2D picture;
uniform vec2 pixel;  // in texture coordinates

in vec2 uv;

out vec4 smoothed;

vec4 colour(vec2 at) { return textureLod(picture, at, 0.0); }  // and brightness

void main() {
    float nw = colour(uv + vec2(-pixel.x, pixel.y)).a, ne = colour(uv + pixel).a;
    float sw = colour(uv - pixel).a, se = colour(uv + vec2(pixel.x, -pixel.y)).a, own = colour(uv).a;
    float low = min(own, min(min(nw, ne), min(sw, se))), high = max(own, max(max(nw, ne), max(sw, se)));
    vec2 way = vec2(-((nw + ne) - (sw + se)), (nw + sw) - (ne + se));
    float shortest = 1.0 / (min(abs(way.x), abs(way.y)) + max((nw + ne + sw + se) * 0.03125, 0.0078125));
    way = clamp(way * shortest, -8.0, 8.0) * pixel;
    vec4 near = 0.5 * (colour(uv - way / 6.0) + colour(uv + way / 6.0));
    vec4 far = 0.5 * near + 0.25 * (colour(uv - way / 2.0) + colour(uv + way / 2.0));
    smoothed = far.a < low || far.a > high ? near : far;
}
