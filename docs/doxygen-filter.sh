#!/bin/sh
# What a header says of itself stands behind \file on the same line; Doxygen wants it on the next.
exec sed 's|^/// \\file |/// \\file\n/// |' "$1"
