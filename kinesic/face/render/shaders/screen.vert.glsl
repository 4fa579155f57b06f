// Triangle over the whole screen at the far plane: the depth test GREATER passes only pixels of the head.
in vec2 corner;

out vec2 uv;  // coordinates of screen-sized textures

void main() {
    uv = 0.5 * corner + 0.5;
    gl_Position = vec4(corner, 1.0, 1.0);
}
