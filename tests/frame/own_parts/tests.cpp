// The installed suites, on a material of one's own.
#include <testing/material_conformance.hpp>

#include <gent.hpp>

namespace supple::test {
INSTANTIATE_TYPED_TEST_SUITE_P(Gent, MaterialConformance, FromModuli<Gent>);
}
