#include <io/surface/surface_formats.hpp>

#include <cctype>
#include <unordered_map>

namespace supple {
namespace {

/// Numbers positions as they come; the same one, to the last bit but for the sign of zero, is one node.
class Positions {
 public:
  explicit Positions(std::vector<Point>& nodes) : nodes_(nodes) {}

  Index node(const Point& x) {
    Key key;
    for (int c = 0; c < 3; ++c) key[c] = std::bit_cast<std::uint64_t>(x[c] == 0 ? 0.0 : x[c]);
    const auto [found, is_new] = index_.try_emplace(key, static_cast<Index>(nodes_.size()));
    if (is_new) nodes_.push_back(x);
    return found->second;
  }

 private:
  using Key = std::array<std::uint64_t, 3>;
  struct Hash {
    std::size_t operator()(const Key& key) const {
      std::uint64_t h = 0;
      for (const std::uint64_t part : key) {
        h = (h ^ part) * 0x9e3779b97f4a7c15;  // Fibonacci hashing
        h ^= h >> 32;
      }
      return h;
    }
  };
  std::vector<Point>& nodes_;
  std::unordered_map<Key, Index, Hash> index_;
};

void tell_of_merging(FileSurface& surface) {
  surface.numbering = "triangles by their place in the file, vertices in the order in which they first come";
  surface.first_number = 1;
  surface.warnings.push_back(std::to_string(surface.corners.size()) + " corners merged to " +
                             std::to_string(surface.nodes.size()) +
                             " nodes by their exact positions, as STL has none of its own");
}

/// The next word must be this one, in capitals or not.
void expect_keyword(Cursor& in, std::string_view expected) {
  std::string word(in.word());
  for (char& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (word != expected)
    in.fail("expected " + std::string(expected) +
            (word.empty() ? ", the file ends" : ", found \"" + word.substr(0, 40) + "\""));
}

bool next_is(Cursor& in, std::string_view expected) {
  const std::string_view word = in.peek();
  return std::equal(word.begin(), word.end(), expected.begin(), expected.end(),
                    [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
}

}  // namespace

bool is_binary_stl(std::string_view bytes) {
  if (bytes.size() < 84) return false;
  Cursor in("", bytes);
  in.set_binary(std::endian::little);
  in.set_position(80);
  const std::uint64_t size = 84 + 50 * std::uint64_t{in.take<std::uint32_t>("a count")};
  // Headers of binary files may begin with "solid", and bytes may follow; but no text has zeros.
  return bytes.size() == size || (bytes.size() > size && bytes.substr(0, size).find('\0') != std::string_view::npos);
}

/// Normals are not read: those of the corners count. \see 3D Systems 1988, "Stereolithography Interface
/// Specification".
void read_binary_stl(Cursor& in, FileSurface& surface) {
  surface.format = "STL, binary";
  in.set_binary(std::endian::little);
  if (in.num_left() < 80) in.fail("expected a header of 80 bytes, the file ends");
  in.set_position(80);
  const auto num_facets = in.take<std::uint32_t>("the number of facets");
  in.expect_room(num_facets, 50, "facets");
  Positions positions(surface.nodes);
  for (std::uint32_t f = 0; f < num_facets; ++f) {
    for (int k = 0; k < 3; ++k) in.take<float>("a normal");
    for (int k = 0; k < 3; ++k) {
      Point x;
      for (double& coordinate : x) coordinate = in.take<float>("a coordinate");
      surface.corners.push_back(positions.node(x));
    }
    surface.end_face();
    in.take<std::uint16_t>("an attribute");
  }
  if (in.num_left() > 0)
    surface.warnings.push_back(std::to_string(in.num_left()) + " bytes follow the last of the " +
                               std::to_string(num_facets) + " facets that the file announces: left out");
  tell_of_merging(surface);
}

void read_ascii_stl(Cursor& in, FileSurface& surface) {
  surface.format = "STL, ASCII";
  Positions positions(surface.nodes);
  do {
    expect_keyword(in, "solid");
    in.rest_of_line();  // its name
    while (!next_is(in, "endsolid")) {
      expect_keyword(in, "facet");
      expect_keyword(in, "normal");
      for (int k = 0; k < 3; ++k) in.word();  // often none that is a number
      expect_keyword(in, "outer");
      expect_keyword(in, "loop");
      for (int k = 0; k < 3; ++k) {
        expect_keyword(in, "vertex");
        Point x;
        for (double& coordinate : x) coordinate = in.real("a coordinate");
        surface.corners.push_back(positions.node(x));
      }
      expect_keyword(in, "endloop");
      expect_keyword(in, "endfacet");
      surface.end_face();
    }
    in.word(), in.rest_of_line();
  } while (!in.peek().empty());
  tell_of_merging(surface);
}

}  // namespace supple
