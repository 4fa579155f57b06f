// What the G-buffer's first texture holds: a unit normal, and as one number the part and the depth z [m] in the frame of
// the camera, which is below 0. The background is 0.
const float APART = 8.0;  // [m] that each part after the skin is further away in that number
const float SKIN = 0.0, EYES = 1.0, TEETH = 2.0, TONGUE = 3.0, LASHES = 4.0;

float part(float where) { return floor(where / -APART); }

float depth(float where) { return where + APART * part(where); }

bool on_skin(float where) { return where < 0.0 && where > -APART; }

// [m] in the frame of the camera; lens is half the screen at a distance of 1.
vec3 position(vec2 uv, vec2 lens, float where) { return depth(where) * vec3((1.0 - 2.0 * uv) * lens, 1.0); }
