// Anti-aliasing by a blur along edges (T. Lottes, FXAA, 2009).
uniform sampler2D picture;
uniform vec2 pixel;  // size in texture coordinates

in vec2 uv;

out vec4 smoothed;

// Interpolated colour and brightness; drivers round interpolated bytes differently.
vec4 colour(vec2 at) {
    vec2 place = at / pixel - 0.5, share = fract(place), low = (floor(place) + 0.5) * pixel;
    vec4 below = mix(textureLod(picture, low, 0.0), textureLod(picture, low + vec2(pixel.x, 0.0), 0.0), share.x);
    vec4 above = mix(textureLod(picture, low + vec2(0.0, pixel.y), 0.0), textureLod(picture, low + pixel, 0.0), share.x);
    return mix(below, above, share.y);
}

float bright(float x, float y) { return textureLod(picture, uv + vec2(x, y) * pixel, 0.0).a; }

void main() {
    float nw = bright(-1.0, 1.0), ne = bright(1.0, 1.0), sw = bright(-1.0, -1.0), se = bright(1.0, -1.0);
    float own = bright(0.0, 0.0);
    float low = min(own, min(min(nw, ne), min(sw, se))), high = max(own, max(max(nw, ne), max(sw, se)));
    vec2 way = vec2(-((nw + ne) - (sw + se)), (nw + sw) - (ne + se));
    float shortest = 1.0 / (min(abs(way.x), abs(way.y)) + max((nw + ne + sw + se) * 0.03125, 0.0078125));
    way = clamp(way * shortest, -8.0, 8.0) * pixel;
    vec4 near = 0.5 * (colour(uv - way / 6.0) + colour(uv + way / 6.0));
    vec4 far = 0.5 * near + 0.25 * (colour(uv - way / 2.0) + colour(uv + way / 2.0));
    smoothed = far.a < low || far.a > high ? near : far;
}
