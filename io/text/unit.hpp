#pragma once
/// \file Units of measurement in scene files and on the command line.

#include <string_view>

namespace supple {

/// How many of `unit` one `given` is: conversion_factor("kPa", "Pa") = 1000. A unit is a product of powers,
/// as in "N/m", "kg m^2 / s^2", "kg·m⁻³" or "1/s", of m, g, s, N, Pa, J, W, Hz, rad, deg (°), min, h, 1 and
/// %, with the prefixes from n to G where they make sense. Angles are numbers: rad = 1. "" is the unit of
/// plain numbers.
/// \throws InputError if `given` is not a unit or measures something else ("'kg' is not a unit of Pa").
double conversion_factor(std::string_view given, std::string_view unit);

/// The value of a quantity like "2.5 MPa" or "3e-2m" in `unit`; a plain number is in `unit` already.
/// \throws InputError as above, or if the text does not start with a finite number.
double parse_quantity(std::string_view text, std::string_view unit);

}  // namespace supple
