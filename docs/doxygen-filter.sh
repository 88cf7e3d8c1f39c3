#!/bin/sh
# What a header says of itself stands behind \file on the same line; Doxygen wants it on the next, and knows no Eigen to
# specialise templates of.
exec sed -e 's|^/// \\file |/// \\file\n/// |' -e 's|^struct Eigen::|struct |' "$1"
