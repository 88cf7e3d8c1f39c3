#include <tests/io/damage.hpp>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <new>
#include <vector>

namespace {
std::atomic<std::size_t> largest = 0;
}

[[gnu::noinline]] void* operator new(std::size_t size) {
  std::size_t so_far = largest;
  while (size > so_far && !largest.compare_exchange_weak(so_far, size)) {
  }
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {  // sorting takes its memory so
  try {
    return operator new(size);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace supple::test {

std::size_t largest_request() {
  return largest;
}
void forget_requests() {
  largest = 0;
}

std::string damaged(std::string bytes, Random& random) {
  static const std::vector<std::string> tokens{"-1",
                                               "0",
                                               "99999999999",
                                               "18446744073709551615",
                                               "nan",
                                               "1e999",
                                               "$Nodes",
                                               "End",
                                               "\n",
                                               " ",
                                               "4611686018427387904",
                                               "#",
                                               "\"",
                                               "<",
                                               "_",
                                               "*SET",
                                               "endloop",
                                               "end_header",
                                               "property list uchar int ",
                                               "f ",
                                               "/",
                                               std::string("\0", 1),
                                               std::string("\xff\xff\xff\xff", 4),
                                               std::string("\0\0\0\x40", 4),
                                               std::string("\xff\xff\xff\x7f", 4)};
  for (Index change = 1 + random.below(3); change > 0 && !bytes.empty(); --change) {
    const auto size = static_cast<Index>(bytes.size());
    const Index at = random.below(size), length = 1 + random.below(std::min<Index>(size - at, 40));
    switch (random.below(8)) {
      case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8)));
        break;
      case 1:
        bytes[at] = static_cast<char>(random.below(256));
        break;
      case 2:
        bytes.erase(at, length);
        break;
      case 3:
        bytes.insert(at, bytes.substr(random.below(size), length));
        break;
      case 4:
        bytes.resize(at);
        break;
      case 5:
        bytes.replace(at, std::min(length, Index{8}), tokens[random.below(static_cast<Index>(tokens.size()))]);
        break;
      case 6:
        bytes.insert(at, tokens[random.below(static_cast<Index>(tokens.size()))]);
        break;
      case 7: {  // another number in place of one of the text
        const std::size_t begin = bytes.find_first_of("0123456789", at);
        if (begin == std::string::npos) break;
        const std::size_t end = std::min(bytes.find_first_not_of("0123456789", begin), bytes.size());
        bytes.replace(begin, end - begin, tokens[random.below(6)]);
        break;
      }
    }
  }
  return bytes;
}

}  // namespace supple::test
