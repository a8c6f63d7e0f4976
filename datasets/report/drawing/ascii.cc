#include "datasets/report/drawing/ascii.h"

#include <algorithm>
#include <array>

#include "schema/text.h"

namespace cairn::datasets::report {
namespace {

struct Range {
  char32_t first;
  std::string_view letters;  // of a character each; '?' where there is none, or in kSeveral
};

// By the Unicode Character Database's decompositions; letters with a stroke by what they look like.
constexpr Range kBaseLetters[] = {
    {0x00C0,
     "AAAAAA?CEEEEIIIIDNOOOOO?OUUUUY??aaaaaa?ceeeeiiiidnooooo?ouuuuy?yAaAaAaCcCcCcCcDdDdEeEeE"
     "eEeEeGgGgGgGgHhHhIiIiIiIiIi??JjKkkLlLlLlLlLlNnNnNnnNnOoOoOo??RrRrRrSsSsSsSsTtTtTtUuUuU"
     "uUuUuUuWwYyYZzZzZzs"},
    {0x01CD, "AaIiOoUuUuUuUuUu"},
    {0x0218, "SsTt"},
    {0x1E00,
     "AaBbBbBbCcDdDdDdDdDdEeEeEeEeEeFfGgHhHhHhHhHhIiIiKkKkKkLlLlLlLlMmMmMmNnNnNnNnOoOoOoOoPpPp"
     "RrRrRrRrSsSsSsSsSsTtTtTtTtUuUuUuUuUuVvVvWwWwWwWwWwXxXxYyZzZzZzhtwy?s????AaAaAaAaAaAaA"
     "aAaAaAaAaAaEeEeEeEeEeEeEeEeIiIiOoOoOoOoOoOoOoOoOoOoOoOoUuUuUuUuUuUuUuYyYyYyYy"},
};

struct Written {
  std::string_view character, as;
};

constexpr Written kSeveral[] = {{"ß", "ss"}, {"ẞ", "SS"}, {"Æ", "AE"}, {"æ", "ae"}, {"Œ", "OE"},
                                {"œ", "oe"}, {"Þ", "Th"}, {"þ", "th"}, {"−", "-"},  {"–", "-"}};

bool IsMark(char32_t code) { return code >= 0x0300 && code <= 0x036F; }  // of the letter before it

char BaseLetter(char32_t code) {
  for (const Range& range : kBaseLetters)
    if (code >= range.first && code < range.first + range.letters.size())
      return range.letters[code - range.first];
  return '?';
}

std::string AsciiOf(std::string_view character) {
  if (character.size() == 1) return std::string(character);
  const auto* const written = std::ranges::find(kSeveral, character, &Written::character);
  if (written != std::end(kSeveral)) return std::string(written->as);
  const char32_t code = CodeAt(character, 0, character.size());
  return IsMark(code) ? "" : std::string(1, BaseLetter(code));
}

}  // namespace

std::string Ascii(std::string_view text) {
  std::string ascii;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t bytes = Utf8Bytes(text, at);
    ascii += bytes == 0 ? "?" : AsciiOf(text.substr(at, bytes));
    at += std::max<std::size_t>(bytes, 1);
  }
  return ascii;
}

}  // namespace cairn::datasets::report
