#include <io/mesh/mesh_formats.hpp>
#include <io/surface/surface_formats.hpp>

#include <optional>

namespace supple {
namespace {

struct NumberType {
  enum Kind { Signed, Unsigned, Floating } kind;
  std::size_t size;
};

NumberType number_type(std::string_view name, const Cursor& in) {
  if (name == "char" || name == "int8") return {NumberType::Signed, 1};
  if (name == "uchar" || name == "uint8") return {NumberType::Unsigned, 1};
  if (name == "short" || name == "int16") return {NumberType::Signed, 2};
  if (name == "ushort" || name == "uint16") return {NumberType::Unsigned, 2};
  if (name == "int" || name == "int32") return {NumberType::Signed, 4};
  if (name == "uint" || name == "uint32") return {NumberType::Unsigned, 4};
  if (name == "float" || name == "float32") return {NumberType::Floating, 4};
  if (name == "double" || name == "float64") return {NumberType::Floating, 8};
  in.fail("expected a type such as int or float32, found \"" + std::string(name.substr(0, 40)) + "\"");
}

struct Property {
  std::string name;
  NumberType type;
  std::optional<NumberType> list_size;  // of the number of entries, if it is a list
};
struct Element {
  std::string name;
  Index count;
  std::vector<Property> properties;

  /// The property that bears one of the names; −1 if none does.
  int find(std::initializer_list<std::string_view> names) const {
    for (std::size_t p = 0; p < properties.size(); ++p)
      for (const std::string_view known : names)
        if (properties[p].name == known) return static_cast<int>(p);
    return -1;
  }
};

/// \see Turk 1994, "The PLY Polygon File Format".
class PlyReader {
 public:
  PlyReader(Cursor& in, FileSurface& surface) : in_(in), surface_(surface) {}

  void read() {
    read_header();
    for (const Element& element : elements_) {
      if (element.properties.empty() || element.count == 0) continue;
      std::size_t least = 0;  // bytes of an element
      for (const Property& property : element.properties)
        least += in_.is_binary() ? property.list_size.value_or(property.type).size : 1;
      in_.expect_room(element.count, least, "elements " + element.name);
      if (element.name == "vertex")
        read_vertices(element);
      else if (element.name == "face")
        read_faces(element);
      else
        for (Index k = 0; k < element.count; ++k)
          for (const Property& property : element.properties) skip(property);
    }
  }

 private:
  void read_header() {
    in_.expect("ply");
    in_.rest_of_line();
    in_.expect("format");
    const std::string format(in_.word_in_line());
    if (format != "ascii" && format != "binary_little_endian" && format != "binary_big_endian")
      in_.fail("expected format ascii, binary_little_endian or binary_big_endian, found \"" + format.substr(0, 40) +
               "\"");
    in_.rest_of_line();
    for (std::string_view keyword = in_.word(); keyword != "end_header"; keyword = in_.word()) {
      if (keyword == "element") {
        Element element;
        element.name = in_.word_in_line();
        element.count = in_.integer_in_line("the number of elements");
        if (element.count < 0) in_.fail("the number of elements is negative");
        for (const Element& other : elements_)
          if (other.name == element.name) in_.fail("a second element " + element.name.substr(0, 40));
        elements_.push_back(std::move(element));
      } else if (keyword == "property") {
        if (elements_.empty()) in_.fail("expected an element before its property");
        elements_.back().properties.push_back(read_property());
      } else if (keyword != "comment" && keyword != "obj_info") {
        in_.fail(keyword.empty() ? "expected end_header, the file ends"
                                 : "expected element, property, comment or end_header, found \"" +
                                       std::string(keyword.substr(0, 40)) + "\"");
      }
      in_.rest_of_line();
    }
    in_.rest_of_line();
    surface_.format = "PLY, " + (format == "ascii"               ? "ASCII"
                                 : format == "binary_big_endian" ? "binary, big endian"
                                                                 : std::string("binary, little endian"));
    for (const Element& element : elements_)
      if (element.name == "vertex") num_nodes_ = element.count;
    if (format != "ascii") in_.set_binary(format == "binary_big_endian" ? std::endian::big : std::endian::little);
  }

  Property read_property() {
    Property property;
    std::string_view word = in_.word_in_line();
    if (word == "list") {
      property.list_size = number_type(in_.word_in_line(), in_);
      if (property.list_size->kind == NumberType::Floating) in_.fail("expected a list with a whole size");
      word = in_.word_in_line();
    }
    property.type = number_type(word, in_);
    property.name = in_.word_in_line();
    return property;
  }

  void read_vertices(const Element& element) {
    std::array<int, 3> at;
    for (int c = 0; c < 3; ++c) {
      at[c] = element.find({std::string_view("xyz").substr(c, 1)});
      if (at[c] < 0 || element.properties[at[c]].list_size)
        in_.fail_whole("element vertex has no number " + std::string(1, "xyz"[c]));
    }
    surface_.nodes.resize(element.count);
    for (Point& x : surface_.nodes)
      for (int p = 0; p < static_cast<int>(element.properties.size()); ++p) {
        const auto c = std::find(at.begin(), at.end(), p) - at.begin();
        if (c < 3)
          x[c] = real(element.properties[p].type);
        else
          skip(element.properties[p]);
      }
  }

  void read_faces(const Element& element) {
    const int corners = element.find({"vertex_indices", "vertex_index"});
    if (corners < 0 || !element.properties[corners].list_size ||
        element.properties[corners].type.kind == NumberType::Floating)
      in_.fail_whole("element face has no list of whole numbers vertex_indices");
    for (Index f = 0; f < element.count; ++f) {
      for (int p = 0; p < static_cast<int>(element.properties.size()); ++p) {
        const Property& property = element.properties[p];
        if (p != corners) {
          skip(property);
          continue;
        }
        const std::int64_t count = list_size(property);
        for (std::int64_t k = 0; k < count; ++k)
          surface_.corners.push_back(node_at(in_, integer(property.type, "a node number"), 0, num_nodes_));
      }
      surface_.end_face();
    }
  }

  std::int64_t list_size(const Property& property) {
    const std::int64_t count = integer(*property.list_size, "the size of a list");
    if (count < 0) in_.fail("the size of a list is negative");
    in_.expect_room(count, in_.is_binary() ? property.type.size : 1, "entries of a list");
    return count;
  }

  void skip(const Property& property) {
    const std::int64_t count = property.list_size ? list_size(property) : 1;
    for (std::int64_t k = 0; k < count; ++k) real(property.type);
  }

  double real(const NumberType& type) {
    if (!in_.is_binary()) return in_.real("a number");
    if (type.kind != NumberType::Floating) return static_cast<double>(integer(type, "a number"));
    return type.size == 4 ? in_.take<float>("a number") : in_.take<double>("a number");
  }

  std::int64_t integer(const NumberType& type, std::string_view what) {
    if (!in_.is_binary()) return in_.integer(what);
    const bool is_signed = type.kind == NumberType::Signed;
    if (type.size == 1) return is_signed ? in_.take<std::int8_t>(what) : in_.take<std::uint8_t>(what);
    if (type.size == 2) return is_signed ? in_.take<std::int16_t>(what) : in_.take<std::uint16_t>(what);
    return is_signed ? std::int64_t{in_.take<std::int32_t>(what)} : in_.take<std::uint32_t>(what);
  }

  Cursor& in_;
  FileSurface& surface_;
  std::vector<Element> elements_;
  Index num_nodes_ = 0;
};

}  // namespace

void read_ply(Cursor& in, FileSurface& surface) {
  PlyReader(in, surface).read();
}

}  // namespace supple
