// A loop over several threads.
#include <core/parallel.hpp>
#include <core/types.hpp>

using namespace supple;

int main() {
  Vector squares(100);
  parallel_for(squares.size(), [&](Index i) { squares[i] = static_cast<double>(i * i); });
  return squares[9] == 81 ? 0 : 1;
}
