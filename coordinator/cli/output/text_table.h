// Columns of text for people.
#pragma once

#include <string>
#include <vector>

namespace cairn::cli {

// A line a row, two spaces between columns, each as wide as its widest cell; the last is left as it is. Rows
// may be of different lengths. Characters of UTF-8 count as one column.
std::string TextTable(const std::vector<std::vector<std::string>>& rows);

}  // namespace cairn::cli
