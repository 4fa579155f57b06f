// Marks where brightness changes between neighbours.
uniform sampler2D picture;

const vec3 BRIGHT = vec3(0.299, 0.587, 0.114);

float bright(ivec2 at) { return dot(texelFetch(picture, at, 0).rgb, BRIGHT); }

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy), last = textureSize(picture, 0) - 1;
    ivec2 before = max(here - 1, ivec2(0)), after = min(here + 1, last);
    float nw = bright(ivec2(before.x, after.y)), ne = bright(after);
    float sw = bright(before), se = bright(ivec2(after.x, before.y)), own = bright(here);
    float low = min(own, min(min(nw, ne), min(sw, se))), high = max(own, max(max(nw, ne), max(sw, se)));
    if (high - low <= max(0.04, 0.125 * high)) discard;
}
