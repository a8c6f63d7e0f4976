// CSV files with a header: columns are found by name, in any order, and others beside them are left alone.
// Fields are separated by commas, or by semicolons or tabs where the header has no comma; with those a number
// may have a decimal comma. A column that is asked for in metres, seconds or radians may be there in another
// unit, which its name says: `range_mm` for `range_m`, `time_ms` for `time_s`, `bearing_deg` for
// `bearing_rad`. Columns are found in letters of either case; where one stands there in small letters, it is
// the one. Lines that begin with '#' are comments, before the header too, which may itself stand behind one;
// but a row of the right number of fields is a row where its first column holds names: '#1' may be one.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/common/text_file.h"

namespace cairn::datasets {

// Of each name where it stands first; the names live as long.
std::map<std::string_view, std::size_t> PlacesOf(const std::vector<std::string>& names);

// Of ASCII: names of columns are the same in either case.
std::string InSmallLetters(std::string_view text);

class CsvReader {
 public:
  // Reads the file (plain or gzipped) and its header. `headers`: sets of columns, of which the file must have
  // all of the first that fits, but for those that end in '?' ("robot?").
  // Throws InputError for a missing file or header, a column that is missing or doubled, seconds beside
  // nanoseconds.
  CsvReader(const std::string& path, const std::vector<std::vector<std::string>>& headers, BadLines* bad);

  std::size_t header() const { return header_; }                            // which set the file has
  const std::vector<std::string>& extra_columns() const { return extra_; }  // left alone
  // Reads those too: they follow the header's columns, in the order of the file.
  // Throws InputError for one without a name of its own.
  void TakeExtraColumns();

  // The same file from its first row on, of which nobody was told yet that lines are bad.
  CsvReader FromFirstRow(BadLines* bad) const;

  // Goes to the next row; lines of a wrong number of columns are bad, empty ones are passed over.
  bool Next();
  std::size_t line() const { return lines_.number(); }
  std::string Place() const;  // "FILE:LINE: ", of the header before the first Next()
  bool Has(std::size_t index) const { return places_[index] != kMissing; }
  // Field of the column `index` of the header, blanks around it cut off; nothing where there is no such
  // column.
  std::string_view Text(std::size_t index) const {
    return Has(index) ? fields_[places_[index]] : std::string_view();
  }
  // The same of a column of names (schema/text.h); nothing where it can be none, and the line is bad.
  std::optional<std::string_view> Name(std::size_t index);
  // The number in a column, in the unit that was asked for; nothing where it is none, and the line is bad.
  std::optional<double> Number(std::size_t index);
  bool skips() const { return bad_->skips(); }  // bad lines
  // Calls the line bad.
  void Bad(const std::string& reason, const std::string& detail = {});

 private:
  bool Split(std::string_view line);  // false: an open quote
  bool IsComment() const;             // the line that was split
  void FindHeader(const std::vector<std::vector<std::string>>& headers);
  // Null where none fits.
  const std::vector<std::string>* Fitting(const std::vector<std::vector<std::string>>& headers) const;
  void CheckForNanoseconds(const std::string& column) const;
  void FindColumns(const std::vector<std::vector<std::string>>& headers, std::string_view line);
  // Where columns of that name stand in the header.
  std::vector<std::size_t> Standing(const std::string& name) const;

  static constexpr std::size_t kMissing = static_cast<std::size_t>(-1);

  std::string path_;
  std::shared_ptr<const std::string> text_;  // stays where it is when the reader moves: lines_ looks into it
  Lines lines_, rows_;                       // rows_: from the first one on
  BadLines* bad_;
  std::vector<std::string> columns_;  // of the header that fits
  std::vector<std::size_t> places_;   // where they stand in a line, or kMissing
  std::vector<double> per_unit_;      // how many of the file's units make one of the column's
  std::vector<std::string> extra_;
  std::size_t header_ = 0, width_ = 0;
  bool begins_with_names_ = false;      // a line, not with a number
  char separator_ = ',', decimal_ = 0;  // of the numbers so far: '.' or ','
  std::vector<std::string_view> fields_;
  std::vector<std::string> unquoted_;
};

}  // namespace cairn::datasets
