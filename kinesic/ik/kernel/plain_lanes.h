// Lanes in plain C++, for compilers without vector types (MSVC); the same operations give the same bits.

#pragma once

#include <cstring>

namespace kinesic::arm {

template <class Number>
struct PlainLanes {
    Number lane[2];

    PlainLanes() = default;
    PlainLanes(Number first, Number second) : lane{first, second} {}
    PlainLanes(Number value) : lane{value, value} {}  // as vector types take a scalar beside them

    template <class Other>
    explicit PlainLanes(const PlainLanes<Other>& other) {  // the same bits
        static_assert(sizeof(Other) == sizeof(Number), "lanes of one width");
        std::memcpy(lane, other.lane, sizeof(lane));
    }

    Number& operator[](size_t which) { return lane[which]; }
    Number operator[](size_t which) const { return lane[which]; }

    PlainLanes operator-() const { return {Number(-lane[0]), Number(-lane[1])}; }
    PlainLanes operator~() const { return {Number(~lane[0]), Number(~lane[1])}; }
    PlainLanes& operator+=(PlainLanes other) { return *this = *this + other; }
    PlainLanes& operator-=(PlainLanes other) { return *this = *this - other; }
    PlainLanes& operator*=(PlainLanes other) { return *this = *this * other; }
    PlainLanes& operator/=(PlainLanes other) { return *this = *this / other; }
    PlainLanes& operator&=(PlainLanes other) { return *this = *this & other; }
    PlainLanes& operator|=(PlainLanes other) { return *this = *this | other; }

    friend PlainLanes operator+(PlainLanes a, PlainLanes b) { return {a.lane[0] + b.lane[0], a.lane[1] + b.lane[1]}; }
    friend PlainLanes operator-(PlainLanes a, PlainLanes b) { return {a.lane[0] - b.lane[0], a.lane[1] - b.lane[1]}; }
    friend PlainLanes operator*(PlainLanes a, PlainLanes b) { return {a.lane[0] * b.lane[0], a.lane[1] * b.lane[1]}; }
    friend PlainLanes operator/(PlainLanes a, PlainLanes b) { return {a.lane[0] / b.lane[0], a.lane[1] / b.lane[1]}; }
    friend PlainLanes operator&(PlainLanes a, PlainLanes b) { return {a.lane[0] & b.lane[0], a.lane[1] & b.lane[1]}; }
    friend PlainLanes operator|(PlainLanes a, PlainLanes b) { return {a.lane[0] | b.lane[0], a.lane[1] | b.lane[1]}; }
    friend PlainLanes operator^(PlainLanes a, PlainLanes b) { return {a.lane[0] ^ b.lane[0], a.lane[1] ^ b.lane[1]}; }
    friend PlainLanes operator<<(PlainLanes a, int bits) {
        return {Number((unsigned long long)a.lane[0] << bits), Number((unsigned long long)a.lane[1] << bits)};
    }
};

using Lanes = PlainLanes<double>;
using Mask = PlainLanes<long long>;  // all bits of a lane are set, or none

inline Mask operator<(Lanes a, Lanes b) { return {-(long long)(a[0] < b[0]), -(long long)(a[1] < b[1])}; }
inline Mask operator>(Lanes a, Lanes b) { return {-(long long)(a[0] > b[0]), -(long long)(a[1] > b[1])}; }
inline Mask operator<=(Lanes a, Lanes b) { return {-(long long)(a[0] <= b[0]), -(long long)(a[1] <= b[1])}; }
inline Mask operator>=(Lanes a, Lanes b) { return {-(long long)(a[0] >= b[0]), -(long long)(a[1] >= b[1])}; }
inline Mask operator==(Lanes a, Lanes b) { return {-(long long)(a[0] == b[0]), -(long long)(a[1] == b[1])}; }
inline Mask operator!=(Lanes a, Lanes b) { return {-(long long)(a[0] != b[0]), -(long long)(a[1] != b[1])}; }
inline Mask operator<(Mask a, Mask b) { return {-(long long)(a[0] < b[0]), -(long long)(a[1] < b[1])}; }

}  // namespace kinesic::arm
