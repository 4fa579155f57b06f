// Depth alone, of clothes where they are.
in float detail;

void main() {
    if (detail > 0.0) discard;
}
