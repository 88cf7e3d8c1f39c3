#pragma once
/// \file Output on a terminal: a progress bar, tables, one-line messages.

#include <core/progress.hpp>
#include <core/text.hpp>

#include <cstdio>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace supple {

/// Shows stage and share on one line of stderr; nothing where stderr is not a terminal.
Progress progress_bar();
/// Takes the line away, for other text or for good.
void clear_progress();

/// "supple: warning: …" on stderr.
void warn(std::string_view message);

/// Names on the left, values on the right, in columns.
using Rows = std::vector<std::pair<std::string, std::string>>;
void print_rows(std::FILE* out, std::string_view title, const Rows& rows);
/// Stages in order, what they leave of the total, and the total.
void print_stages(std::FILE* out, const std::vector<std::pair<std::string, double>>& seconds, double total);

std::string shown_percent(double share, int digits = 3);
std::string shown_count(long long count);       ///< "95 142"
std::string shown_iterations(long long count);  ///< "1 iteration", "2 iterations"
std::string shown_bytes(double bytes);

}  // namespace supple
