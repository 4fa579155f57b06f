// First texture of the G-buffer: unit normal, and one number with the part and the negative depth z [m] in the camera's
// frame. The background is 0.
const float APART = 8.0;  // [m] depth offset per part in that number
const float SKIN = 0.0, EYES = 1.0, TEETH = 2.0, TONGUE = 3.0, LASHES = 4.0;

float part(float where) { return floor(where / -APART); }

float depth(float where) { return where + APART * part(where); }

bool on_skin(float where) { return where < 0.0 && where > -APART; }

// Position [m] in the camera's frame; lens is half the screen size at distance 1.
vec3 position(vec2 uv, vec2 lens, float where) { return depth(where) * vec3((1.0 - 2.0 * uv) * lens, 1.0); }
