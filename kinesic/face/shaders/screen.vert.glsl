// One triangle over the whole screen at the far plane: with the depth test GREATER only pixels of the head pass.
in vec2 corner;

void main() {
    gl_Position = vec4(corner, 1.0, 1.0);
}
