// Texts and figures as HTML. All that a stranger may have written goes through Text().
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace cairn::page {

// For the text of an element and for a value in double quotes; what is not to be seen is written out.
std::string Text(std::string_view text);
// One part of a path or a value of a query in an address.
std::string UrlPart(std::string_view text);

std::string Duration(double seconds);  // "0:07", "1:02:09"
std::string Count(std::uint64_t count, const std::string& noun);
std::string Number(double value);  // four digits that count, no exponent where it can be helped

// Saves the picture ("SVG") or the table ("CSV") that it stands beside: of its figure, or of its section.
std::string SaveButton(const std::string& kind, const std::string& what);

// The sign and the word of a state of a job or worker.
std::string StateBadge(const std::string& state);
// Of 0 to 1; below 0: nothing is known.
std::string ProgressBar(double part, const std::string& label);

}  // namespace cairn::page
