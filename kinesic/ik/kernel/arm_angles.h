// Sine, cosine and arc tangent in plain arithmetic: bit-identical on all IEEE processors, and without tables that an
// occasional call would find uncached. Within three units in the last place of the true value.

#pragma once

namespace kinesic::arm {

struct Turn {
    double cosine, sine;
};

// Cosine and sine of an angle of a few turns [rad].
Turn turn_of(double angle);

// Angle of the point (x, y), like std::atan2 of finite numbers.
double arctangent(double y, double x);

// Arc cosine of a number in -1..1.
double arccosine(double x);

}  // namespace kinesic::arm
