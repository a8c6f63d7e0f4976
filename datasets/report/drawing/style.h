// How shapes look, by the classes that they are of: one table, of which a page's style sheet is made and by
// which pictures are drawn into files.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "datasets/report/drawing/palette.h"

namespace cairn::datasets::report {

// What a class says, as CSS has it; what it leaves out, others say. Lengths are in pixels.
struct Look {
  std::string_view name;
  std::string_view fill = {}, stroke = {};  // colours by name, or "none"
  std::optional<double> fill_opacity = {}, stroke_opacity = {}, width = {}, font = {};
  std::string_view dashes = {};  // "6 3": drawn, left out
  std::string_view anchor = {};  // of text: start, middle, end
  bool bold = false;
};

// Of a shape of these classes, "path r2": the table's rows one over another, with the sizes of plain text.
Look LookOf(std::string_view classes);

// Of a name in the look of a shape of these classes, on white paper; none of "none" and of no name.
std::optional<Rgb> ColourOf(std::string_view name, std::string_view classes);

// A page's style sheet: the table's rules among those of words and tables, for light and dark schemes, phones
// and print.
std::string PageCss();

}  // namespace cairn::datasets::report
