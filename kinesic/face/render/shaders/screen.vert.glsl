// One triangle over the whole screen at the far plane: with the depth test GREATER only pixels of the head pass.
in vec2 corner;

out vec2 uv;  // of textures as large as the screen

void main() {
    uv = 0.5 * corner + 0.5;
    gl_Position = vec4(corner, 1.0, 1.0);
}
