// Depth of clothes, discarded beyond their border.
in float detail;

void main() {
    if (detail > 0.0) discard;
}
