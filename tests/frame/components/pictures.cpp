// An image is written and read again.
#include <io/picture/image.hpp>

using namespace supple;

int main() {
  write_png("red.png", Image(4, 3, {1, 0, 0}));
  return read_png("red.png").width == 4 ? 0 : 1;
}
