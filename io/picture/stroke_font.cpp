#include <io/picture/stroke_font.hpp>

#include <algorithm>
#include <charconv>
#include <map>
#include <string>

namespace supple {

namespace {

constexpr float capital_height = 14, gap = 3.1f, word_space = 5.5f;
constexpr int segments_per_curve = 8;

/// A character drawn by SVG's path commands M, L, Q and Z: capitals are 14 high, small letters 10, digits 9
/// wide.
struct Glyph {
  std::string_view character, path;
};
constexpr Glyph glyphs[] = {
    {"A", "M0 0 L5 14 L10 0 M1.7 4.8 L8.3 4.8"},
    {"B", "M0 0 L0 14 L4.5 14 Q8 14 8 10.8 Q8 7.5 4.5 7.5 L0 7.5 M4.5 7.5 Q9 7.5 9 3.8 Q9 0 4.5 0 L0 0"},
    {"C", "M9.4 11 Q8.3 14 5 14 Q0 14 0 7 Q0 0 5 0 Q8.3 0 9.4 3"},
    {"D", "M0 0 L0 14 L4 14 Q9.5 14 9.5 7 Q9.5 0 4 0 Z"},
    {"E", "M8 14 L0 14 L0 0 L8 0 M0 7.5 L7 7.5"},
    {"F", "M8 14 L0 14 L0 0 M0 7.5 L7 7.5"},
    {"G", "M9.3 11.2 Q8.2 14 5 14 Q0 14 0 7 Q0 0 5 0 Q9.8 0 9.8 6.2 L5.6 6.2"},
    {"H", "M0 0 L0 14 M9 0 L9 14 M0 7.5 L9 7.5"},
    {"I", "M0 0 L0 14"},
    {"J", "M6 14 L6 4 Q6 0 3 0 Q0.4 0 0 3"},
    {"K", "M0 0 L0 14 M8 14 L0 6 M3 9 L8.5 0"},
    {"L", "M0 14 L0 0 L7 0"},
    {"M", "M0 0 L0 14 L5.5 3.5 L11 14 L11 0"},
    {"N", "M0 0 L0 14 L9 0 L9 14"},
    {"O", "M5.2 14 Q0 14 0 7 Q0 0 5.2 0 Q10.4 0 10.4 7 Q10.4 14 5.2 14 Z"},
    {"P", "M0 0 L0 14 L4.7 14 Q8.7 14 8.7 10 Q8.7 6 4.7 6 L0 6"},
    {"Q", "M5.2 14 Q0 14 0 7 Q0 0 5.2 0 Q10.4 0 10.4 7 Q10.4 14 5.2 14 Z M6.4 3.6 L10.2 -1"},
    {"R", "M0 0 L0 14 L4.7 14 Q8.7 14 8.7 10.2 Q8.7 6.4 4.7 6.4 L0 6.4 M4.7 6.4 L9 0"},
    {"S", "M8.3 11.2 Q7.6 14 4.5 14 Q0.6 14 0.6 10.7 Q0.6 8 4.5 7.2 Q8.8 6.3 8.8 3.5 Q8.8 0 4.4 0 Q0.8 0 0 2.9"},
    {"T", "M0 14 L9.6 14 M4.8 14 L4.8 0"},
    {"U", "M0 14 L0 5 Q0 0 4.5 0 Q9 0 9 5 L9 14"},
    {"V", "M0 14 L5 0 L10 14"},
    {"W", "M0 14 L3.6 0 L7.2 12 L10.8 0 L14.4 14"},
    {"X", "M0 14 L9 0 M9 14 L0 0"},
    {"Y", "M0 14 L4.8 6.8 L9.6 14 M4.8 6.8 L4.8 0"},
    {"Z", "M0 14 L9 14 L0 0 L9 0"},
    {"a", "M0.8 8.7 Q1.7 10 3.8 10 Q6.8 10 6.8 6.8 L6.8 0 M6.8 5.8 L3.6 5.8 Q0 5.8 0 2.9 Q0 0 3 0 Q6.3 0 6.8 3"},
    {"b", "M0 14 L0 0 M0 5.5 Q0.4 10 4 10 Q7.8 10 7.8 5 Q7.8 0 4 0 Q0.4 0 0 4.5"},
    {"c", "M7 8 Q6.2 10 4 10 Q0 10 0 5 Q0 0 4 0 Q6.2 0 7 2"},
    {"d", "M7.8 14 L7.8 0 M7.8 5.5 Q7.4 10 3.8 10 Q0 10 0 5 Q0 0 3.8 0 Q7.4 0 7.8 4.5"},
    {"e", "M0 5.4 L7.7 5.4 Q7.7 10 4 10 Q0 10 0 5 Q0 0 4.2 0 Q6.6 0 7.4 2"},
    {"f", "M5.4 13.9 Q2.2 14.6 2.2 11 L2.2 0 M0 9.6 L5 9.6"},
    {"g",
     "M7.8 10 L7.8 -0.6 Q7.8 -4 4 -4 Q1.6 -4 0.7 -2.6 M7.8 5.5 Q7.4 10 3.8 10 Q0 10 0 5 Q0 0 3.8 0 Q7.4 0 "
     "7.8 4.5"},
    {"h", "M0 14 L0 0 M0 5.5 Q0.6 10 3.9 10 Q7 10 7 6.5 L7 0"},
    {"i", "M0 9.8 L0 0 M-0.25 13.5 L0.25 13.5 L0.25 14 L-0.25 14 Z"},
    {"j", "M1.6 9.8 L1.6 -1.6 Q1.6 -4 -0.6 -3.9 M1.35 13.5 L1.85 13.5 L1.85 14 L1.35 14 Z"},
    {"k", "M0 14 L0 0 M6.6 10 L0 3.8 M2.6 6.2 L7 0"},
    {"l", "M0 14 L0 2 Q0 0.1 1.7 0.1"},
    {"m",
     "M0 10 L0 0 M0 5.5 Q0.5 10 3.1 10 Q5.6 10 5.6 6.5 L5.6 0 M5.6 5.5 Q6.1 10 8.7 10 Q11.2 10 11.2 6.5 "
     "L11.2 0"},
    {"n", "M0 10 L0 0 M0 5.5 Q0.6 10 3.9 10 Q7 10 7 6.5 L7 0"},
    {"o", "M4 10 Q0 10 0 5 Q0 0 4 0 Q8 0 8 5 Q8 10 4 10 Z"},
    {"p", "M0 10 L0 -4 M0 5.5 Q0.4 10 4 10 Q7.8 10 7.8 5 Q7.8 0 4 0 Q0.4 0 0 4.5"},
    {"q", "M7.8 10 L7.8 -4 M7.8 5.5 Q7.4 10 3.8 10 Q0 10 0 5 Q0 0 3.8 0 Q7.4 0 7.8 4.5"},
    {"r", "M0 10 L0 0 M0 5 Q0.6 10.2 4.3 9.8"},
    {"s", "M6.2 8.1 Q5.6 10 3.3 10 Q0.4 10 0.4 7.6 Q0.4 5.8 3.3 5.2 Q6.7 4.5 6.7 2.5 Q6.7 0 3.3 0 Q0.6 0 0 2"},
    {"t", "M2.2 13 L2.2 3 Q2.2 -0.3 5.2 0.2 M0 9.6 L5 9.6"},
    {"u", "M0 10 L0 3.5 Q0 0 3.1 0 Q6.4 0 7 4.5 M7 10 L7 0"},
    {"v", "M0 10 L3.9 0 L7.8 10"},
    {"w", "M0 10 L2.9 0 L5.8 9 L8.7 0 L11.6 10"},
    {"x", "M0 10 L7 0 M7 10 L0 0"},
    {"y", "M0 10 L3.9 0 M7.8 10 L3.2 -2 Q2.4 -4 0.2 -3.9"},
    {"z", "M0 10 L6.8 10 L0 0 L6.8 0"},
    {"0", "M4.5 14 Q0 14 0 7 Q0 0 4.5 0 Q9 0 9 7 Q9 14 4.5 14 Z"},
    {"1", "M1 11 L4.8 14 L4.8 0"},
    {"2", "M0.5 10.4 Q0.8 14 4.6 14 Q8.5 14 8.5 10.4 Q8.5 8 6 5.6 L0.2 0 L9 0"},
    {"3",
     "M0.6 11.3 Q1.5 14 4.4 14 Q8.3 14 8.3 10.7 Q8.3 7.5 3.8 7.5 M3.8 7.5 Q9 7.5 9 3.7 Q9 0 4.4 0 Q0.8 0 0 "
     "2.9"},
    {"4", "M6.6 0 L6.6 14 L0 4 L9 4"},
    {"5", "M8 14 L1.4 14 L0.7 7.4 Q2 9 4.5 9 Q9 9 9 4.5 Q9 0 4.3 0 Q1 0 0 2.6"},
    {"6", "M7.9 13 Q6.8 14 5 14 Q0 14 0 6 Q0 0 4.6 0 Q9 0 9 4.4 Q9 8.6 4.7 8.6 Q0.8 8.6 0 5"},
    {"7", "M0 14 L9 14 L3 0"},
    {"8",
     "M4.5 14 Q0.7 14 0.7 10.8 Q0.7 7.6 4.5 7.6 Q8.3 7.6 8.3 10.8 Q8.3 14 4.5 14 Z "
     "M4.5 7.6 Q0 7.6 0 3.8 Q0 0 4.5 0 Q9 0 9 3.8 Q9 7.6 4.5 7.6 Z"},
    {"9", "M1.1 1 Q2.2 0 4 0 Q9 0 9 8 Q9 14 4.4 14 Q0 14 0 9.6 Q0 5.4 4.3 5.4 Q8.2 5.4 9 9"},
    {".", "M0.25 0 L0.75 0 L0.75 0.5 L0.25 0.5 Z"},
    {",", "M1 0.3 L0 -2.6"},
    {":", "M0.25 0 L0.75 0 L0.75 0.5 L0.25 0.5 Z M0.25 8.3 L0.75 8.3 L0.75 8.8 L0.25 8.8 Z"},
    {";", "M1 0.3 L0 -2.6 M0.75 8.3 L1.25 8.3 L1.25 8.8 L0.75 8.8 Z"},
    {"!", "M0.5 14 L0.5 4.2 M0.25 0 L0.75 0 L0.75 0.5 L0.25 0.5 Z"},
    {"?", "M0 11 Q0.4 14 3.6 14 Q7 14 7 10.8 Q7 8.6 5 7.3 Q3.5 6.3 3.5 4.2 M3.25 0 L3.75 0 L3.75 0.5 L3.25 0.5 Z"},
    {"'", "M0.5 14 L0.5 10.4"},
    {"\"", "M0.5 14 L0.5 10.4 M3.7 14 L3.7 10.4"},
    {"`", "M0 14 L2 11.6"},
    {"-", "M0 5.6 L4.6 5.6"},
    {"–", "M0 5.6 L8 5.6"},
    {"—", "M0 5.6 L13 5.6"},
    {"−", "M0 6 L8.6 6"},
    {"_", "M0 -2.4 L8.6 -2.4"},
    {"+", "M0 6 L8.6 6 M4.3 1.7 L4.3 10.3"},
    {"±", "M0 7.4 L8.6 7.4 M4.3 3.1 L4.3 11.7 M0 0.4 L8.6 0.4"},
    {"=", "M0 8 L8.6 8 M0 4 L8.6 4"},
    {"≈", "M0 7.4 Q2.2 10 4.3 8.2 Q6.4 6.4 8.6 9 M0 3.2 Q2.2 5.8 4.3 4 Q6.4 2.2 8.6 4.8"},
    {"~", "M0 5.2 Q2.2 7.8 4.3 6 Q6.4 4.2 8.6 6.8"},
    {"<", "M8 10.6 L0 6 L8 1.4"},
    {">", "M0 10.6 L8 6 L0 1.4"},
    {"≤", "M8 11.6 L0 7.6 L8 3.6 M0 0.4 L8 0.4"},
    {"≥", "M0 11.6 L8 7.6 L0 3.6 M0 0.4 L8 0.4"},
    {"→", "M0 6 L11 6 M7 10 L11 6 L7 2"},
    {"/", "M0 -1.4 L5.6 15.4"},
    {"\\", "M0 15.4 L5.6 -1.4"},
    {"(", "M3.2 16 Q0 12 0 6.4 Q0 0.8 3.2 -3.2"},
    {")", "M0 16 Q3.2 12 3.2 6.4 Q3.2 0.8 0 -3.2"},
    {"[", "M3 16 L0 16 L0 -3 L3 -3"},
    {"]", "M0 16 L3 16 L3 -3 L0 -3"},
    {"{", "M4 16 Q1.8 16 1.8 13.5 L1.8 9 Q1.8 6.5 0 6.5 Q1.8 6.5 1.8 4 L1.8 -0.5 Q1.8 -3 4 -3"},
    {"}", "M0 16 Q2.2 16 2.2 13.5 L2.2 9 Q2.2 6.5 4 6.5 Q2.2 6.5 2.2 4 L2.2 -0.5 Q2.2 -3 0 -3"},
    {"|", "M0 16 L0 -3"},
    {"‖", "M0 16 L0 -3 M3.2 16 L3.2 -3"},
    {"*", "M3.4 14 L3.4 7.6 M0.6 12.4 L6.2 9.2 M6.2 12.4 L0.6 9.2"},
    {"×", "M0.4 9.8 L8 2.2 M8 9.8 L0.4 2.2"},
    {"·", "M0.5 5.9 L0.5 6"},
    {"⊗", "M4.8 11 Q0 11 0 6 Q0 1 4.8 1 Q9.6 1 9.6 6 Q9.6 11 4.8 11 Z M1.4 9.4 L8.2 2.6 M8.2 9.4 L1.4 2.6"},
    {"%",
     "M2.6 14 Q0 14 0 10.8 Q0 7.6 2.6 7.6 Q5.2 7.6 5.2 10.8 Q5.2 14 2.6 14 Z "
     "M9.6 6.4 Q7 6.4 7 3.2 Q7 0 9.6 0 Q12.2 0 12.2 3.2 Q12.2 6.4 9.6 6.4 Z M10.4 14 L1.8 0"},
    {"&",
     "M10 0 L2.6 9 Q0.6 11.4 1.6 12.9 Q2.6 14.2 4.2 14 Q6.6 13.6 6.6 11.4 Q6.6 9.6 3.4 7.8 Q0 6 0 3.4 Q0 0 "
     "3.8 0 Q8 0 9.2 5.6"},
    {"#", "M3.4 14 L1.6 0 M8.2 14 L6.4 0 M0.4 9.4 L9.8 9.4 M0 4.6 L9.4 4.6"},
    {"$",
     "M8.3 11.2 Q7.6 13.6 4.5 13.6 Q0.6 13.6 0.6 10.5 Q0.6 8 4.5 7.2 Q8.8 6.3 8.8 3.6 Q8.8 0.4 4.4 0.4 Q0.8 "
     "0.4 0 3 M4.5 16 L4.5 -2"},
    {"@",
     "M9.6 8.6 Q9.2 9.8 7.2 9.8 Q4 9.8 4 6.4 Q4 3 7 3 Q9.6 3 9.6 6.6 L9.6 9.8 M9.6 6 Q9.6 3 11.4 3 Q13.4 3 "
     "13.4 7 Q13.4 14 7 14 Q0 14 0 6 Q0 -2 7 -2 Q9.6 -2 11.2 -1"},
    {"^", "M0 8.6 L3.6 14 L7.2 8.6"},
    {"°", "M2.4 14 Q0 14 0 11.6 Q0 9.2 2.4 9.2 Q4.8 9.2 4.8 11.6 Q4.8 14 2.4 14 Z"},
    {"¹", "M0 12.8 L2 14.2 L2 7"},
    {"²", "M0 12.4 Q0.2 14.2 2.2 14.2 Q4.4 14.2 4.4 12.2 Q4.4 11 3 9.8 L0 7 L4.6 7"},
    {"³",
     "M0.2 12.8 Q0.6 14.2 2.2 14.2 Q4.2 14.2 4.2 12.6 Q4.2 10.9 2 10.9 M2 10.9 Q4.6 10.9 4.6 9 Q4.6 7 2.2 7 "
     "Q0.4 7 0 8.4"},
    {"⁻", "M0 10.6 L3.6 10.6"},
    {"…",
     "M0.25 0 L0.75 0 L0.75 0.5 L0.25 0.5 Z M4.65 0 L5.15 0 L5.15 0.5 L4.65 0.5 Z M9.05 0 L9.55 0 L9.55 0.5 "
     "L9.05 0.5 Z"},
    {"α", "M8.6 10 Q7 4.6 6 2.4 Q4.8 0 3.2 0 Q0 0 0 5 Q0 10 3.4 10 Q5.6 10 6.6 5 Q7.6 0 9.2 0.2"},
    {"β", "M0 -4 L0 10.4 Q0 14 3.6 14 Q7 14 7 10.9 Q7 7.8 3.2 7.8 M3.2 7.8 Q8 7.8 8 3.9 Q8 0 4 0 Q0.6 0 0 3"},
    {"δ", "M6.4 13.4 Q4.6 14.4 3 13.6 Q1 12.4 3 10.6 L5.6 8.4 Q8 6.6 8 4.2 Q8 0 4 0 Q0 0 0 4.4 Q0 8.4 4.6 9.2"},
    {"ε", "M6 8.4 Q5 10 3.2 10 Q0.5 10 0.5 7.6 Q0.5 5.3 3.6 5.3 Q0 5.3 0 2.6 Q0 0 3.2 0 Q5.6 0 6.4 1.8"},
    {"η", "M0 10 L0 0 M0 5.5 Q0.6 10 3.9 10 Q7 10 7 6.5 L7 -4"},
    {"θ", "M4 14 Q0 14 0 7 Q0 0 4 0 Q8 0 8 7 Q8 14 4 14 Z M0 7 L8 7"},
    {"λ", "M0.4 13.8 Q2.2 14.4 3 12 L7.6 0 M4.2 8.8 L0 0"},
    {"µ", "M0 10 L0 -4 M0 3.5 Q0 0 3.1 0 Q6.4 0 7 4.5 M7 10 L7 0"},
    {"ν", "M0 10 L3.7 0 Q7.4 6 7.4 10"},
    {"π", "M0 9.6 L9.2 9.6 M2.2 9.6 L1.6 0 M6.8 9.6 L6.8 2 Q6.8 -0.2 8.6 0.2"},
    {"ρ", "M0 -4 L0 5 Q0 10 4 10 Q7.8 10 7.8 5 Q7.8 0 4 0 Q0.6 0 0 4"},
    {"σ", "M8.8 10 L4 10 Q0 10 0 5 Q0 0 4 0 Q8 0 8 5 Q8 8.6 5.6 10"},
    {"τ", "M0 9.6 L7.4 9.6 M3.7 9.6 L3.7 2.4 Q3.7 -0.2 6 0.2"},
    {"φ", "M5 13.4 L5 -4 M5 10 Q0 10 0 5 Q0 0 5 0 Q10 0 10 5 Q10 10 5 10 Z"},
    {"ω", "M2 10 Q0 8 0 4.6 Q0 0 2.8 0 Q5.4 0 5.4 6 Q5.4 0 8 0 Q10.8 0 10.8 4.6 Q10.8 8 8.8 10"},
    {"Δ", "M0 0 L5.4 14 L10.8 0 Z"},
    {"Σ", "M8.6 14 L0 14 L5.4 7.2 L0 0 L8.8 0"},
    {"Ω", "M0 0 L3.6 0 L3.6 1.4 Q0 3.8 0 8 Q0 14 5.4 14 Q10.8 14 10.8 8 Q10.8 3.8 7.2 1.4 L7.2 0 L10.8 0"},
    {"ä",
     "M0.8 8.7 Q1.7 10 3.8 10 Q6.8 10 6.8 6.8 L6.8 0 M6.8 5.8 L3.6 5.8 Q0 5.8 0 2.9 Q0 0 3 0 Q6.3 0 6.8 3 "
     "M1.55 13.5 L2.05 13.5 L2.05 14 L1.55 14 Z M5.15 13.5 L5.65 13.5 L5.65 14 L5.15 14 Z"},
    {"ö",
     "M4 10 Q0 10 0 5 Q0 0 4 0 Q8 0 8 5 Q8 10 4 10 Z M1.95 13.5 L2.45 13.5 L2.45 14 L1.95 14 Z M5.55 13.5 "
     "L6.05 13.5 L6.05 14 L5.55 14 Z"},
    {"ü",
     "M0 10 L0 3.5 Q0 0 3.1 0 Q6.4 0 7 4.5 M7 10 L7 0 M1.55 13.5 L2.05 13.5 L2.05 14 L1.55 14 Z M4.95 13.5 "
     "L5.45 13.5 L5.45 14 L4.95 14 Z"},
    {"é", "M0 5.4 L7.7 5.4 Q7.7 10 4 10 Q0 10 0 5 Q0 0 4.2 0 Q6.6 0 7.4 2 M5.4 14.4 L3.6 12.2"},
};
constexpr std::string_view box = "M0 0 L0 14 L7 14 L7 0 Z";

TextStrokes trace(std::string_view path) {
  TextStrokes glyph;
  Eigen::Vector2f start = Eigen::Vector2f::Zero(), at = start;
  const auto number = [&path] {
    path.remove_prefix(std::min(path.find_first_of("-.0123456789"), path.size()));
    float value = 0;
    path.remove_prefix(
        static_cast<std::size_t>(std::from_chars(path.data(), path.data() + path.size(), value).ptr - path.data()));
    return value / capital_height;
  };
  const auto point = [&] {
    const float x = number();
    return Eigen::Vector2f(x, number());
  };
  const auto line_to = [&](const Eigen::Vector2f& end) {
    glyph.segments.push_back({at, end});
    at = end;
  };
  while (!path.empty()) {
    const char command = path.front();
    path.remove_prefix(1);
    if (command == 'M') start = at = point();
    if (command == 'L') line_to(point());
    if (command == 'Z') line_to(start);
    if (command == 'Q') {
      const Eigen::Vector2f from = at, control = point(), to = point();
      for (int k = 1; k <= segments_per_curve; ++k) {
        const float t = static_cast<float>(k) / segments_per_curve;
        line_to((1 - t) * (1 - t) * from + 2 * t * (1 - t) * control + t * t * to);
      }
    }
  }
  for (const TextStrokes::Segment& segment : glyph.segments)
    glyph.width = std::max({glyph.width, segment.a.x(), segment.b.x()});
  return glyph;
}

const TextStrokes& find_glyph(std::string_view character) {
  static const std::map<std::string_view, TextStrokes> traced = [] {
    std::map<std::string_view, TextStrokes> all;
    for (const Glyph& glyph : glyphs) {
      TextStrokes strokes = trace(glyph.path);
      if ('0' <= glyph.character[0] && glyph.character[0] <= '9') strokes.width = 9 / capital_height;
      all[glyph.character] = std::move(strokes);
    }
    all["μ"] = all["µ"];
    all[""] = trace(box);
    return all;
  }();
  const auto found = traced.find(character);
  return found == traced.end() ? traced.at("") : found->second;
}

}  // namespace

TextStrokes lay_out(std::string_view text) {
  TextStrokes line;
  float x = 0;
  while (!text.empty()) {
    std::size_t size = 1;
    while (size < text.size() && (static_cast<unsigned char>(text[size]) & 0xc0) == 0x80) ++size;
    const std::string_view character = text.substr(0, size);
    text.remove_prefix(size);
    if (character == " ") {
      x += word_space / capital_height;
      continue;
    }
    const TextStrokes& glyph = find_glyph(character);
    const Eigen::Vector2f shift(x, 0);
    for (const auto& [a, b] : glyph.segments) line.segments.push_back({a + shift, b + shift});
    x += glyph.width + gap / capital_height;
    line.width = x - gap / capital_height;
  }
  line.width = std::max(line.width, x - gap / capital_height);
  return line;
}

}  // namespace supple
