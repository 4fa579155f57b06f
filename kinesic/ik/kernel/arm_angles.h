// Sine, cosine and arc tangent in plain arithmetic: the same bits wherever doubles are IEEE's, and no tables that an
// occasional call would find cold. Within three units in the last place of the true value.

#pragma once

namespace kinesic::arm {

struct Turn {
    double cosine, sine;
};

// Of an angle of a few turns.
Turn turn_of(double angle);

// The angle of the point (x, y), as std::atan2 of finite numbers.
double arctangent(double y, double x);

// Of -1 to 1.
double arccosine(double x);

}  // namespace kinesic::arm
