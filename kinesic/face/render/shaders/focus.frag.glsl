// Depth of field (thesis 12.1): each pixel gathers TAPS samples from its circle of confusion.
uniform sampler2D form;
uniform sampler2D picture;
uniform vec2 lens;     // maximum radius in texture coordinates
uniform float sharp;   // [m] sharp depth
uniform float within;  // [m] half range of sharp depths

const float BEHIND = 4.0;     // [m] depth of the background
const float TURN = 2.399963;  // golden angle

in vec2 uv;

out vec4 focused;

// Circle of confusion relative to its maximum (12.1.1), and depth.
vec2 circle(vec2 there) {
    float where = textureLod(form, there, 0.0).w, away = where < 0.0 ? -depth(where) : BEHIND;
    return vec2(max(abs(away - sharp) - within, 0.0) / away, away);
}

void main() {
    vec2 own = circle(uv), way = vec2(1.0, 0.0);
    vec4 sum = textureLod(picture, uv, 0.0);
    float weights = 1.0;
    mat2 turn = mat2(cos(TURN), sin(TURN), -sin(TURN), cos(TURN));
    int gathered = own.x > 0.0 ? TAPS : 0;
    for (int k = 1; k <= gathered; ++k) {
        float share = sqrt(float(k) / float(TAPS));
        vec2 there = uv + share * own.x * lens * way, other = circle(there);
        float spreads = other.y > own.y ? 1.0 : clamp(8.0 * (other.x / own.x - share) + 1.0, 0.0, 1.0);  // sharp pixels stay sharp
        sum += spreads * textureLod(picture, there, 0.0);
        weights += spreads;
        way = turn * way;
    }
    focused = sum / weights;
}
