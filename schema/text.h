// Texts of strangers: what may be a name, asked once where it comes in; and what is shown of any text.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "schema/error.h"

namespace cairn {

class Blob;

inline constexpr std::size_t kMostNameBytes = 256;      // of a robot, a landmark, a run
inline constexpr std::size_t kMostTextBytes = 4096;     // of an element of any list of texts
inline constexpr std::size_t kMostDatasetBytes = 1024;  // of a dataset's name, all its groups counted

// Bytes of the character of UTF-8 that begins at `at`; 0 where none does (RFC 3629, section 4).
std::size_t Utf8Bytes(std::string_view text, std::size_t at);
// The character itself, of so many bytes, which Utf8Bytes has told.
char32_t CodeAt(std::string_view text, std::size_t at, std::size_t bytes);

// What is wrong with a name: "is longer than 256 bytes", "is not UTF-8", "has control characters"; empty
// where nothing is. Control characters are C0, DEL and C1, and those that turn the direction of writing
// around.
std::string WhatIsWrongWithName(std::string_view name, std::size_t most_bytes = kMostNameBytes);
// The same of a text for people, which may have lines and tabs, and any length.
std::string WhatIsWrongWithText(std::string_view text);

// kCorrupt where the blob is none that a file holds: the name of a dataset has a NUL or a part that is empty
// or
// '.', lies kMostLevels deep, or is that of a group; an array has more than kMostDimensions.
inline constexpr std::ptrdiff_t kMostLevels = 32;
inline constexpr std::size_t kMostDimensions = 32;
Status CheckForms(const Blob& blob);
// That, and kCorrupt where a name of a dataset or a text is not as it should be: texts of a list are names
// (of `robots`, `landmarks` and `runs` of at most kMostNameBytes), a text alone may have lines.
Status CheckTexts(const Blob& blob);

// The first `most` bytes of it, fewer where the last would be part of a character; all where it has no more.
std::string CutTo(std::string_view text, std::size_t most);

// For a terminal, a log, a page: all but newlines and tabs that is not to be seen is written as \u001b, and a
// byte that is no UTF-8 as \xff. Within JSON, where neither can stand unescaped but DEL and C1, it stays
// JSON.
std::string Escaped(std::string_view text);

// The same of a name, of which a newline, which would make a line of its own, and a tab are written as \n,
// \t.
std::string EscapedName(std::string_view name);

// What others wrote, made fit for a log, a terminal and a message: no control characters, nothing but whole
// characters of UTF-8 (else '?'), at most `most_bytes` and a '…'.
std::string Printable(const std::string& text, std::size_t most_bytes);

// For tables: the characters of UTF-8, a column each; and the text with spaces behind it, as wide at least.
std::size_t TextColumns(std::string_view text);
std::string Padded(std::string text, std::size_t columns);

// Names in a message, some of them, for a log may have thousands: "'ann', 'bob' and 3 more"; "none" where
// there are none.
std::string NameList(const std::vector<std::string>& names, std::size_t most = 5);

// A path or a name as a shell takes it for one word.
std::string ShellWord(const std::string& text);

// "1.5 GB", for people.
std::string BytesText(std::uint64_t bytes);

}  // namespace cairn
