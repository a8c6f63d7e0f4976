#include "datasets/import/errors.h"

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "datasets/import/csv_reader.h"
#include "schema/error.h"

namespace cairn::datasets {
namespace {

constexpr std::size_t kMostPlaces = 4096;

struct ErrorTable {
  std::vector<double> x_m, y_m, error;
  std::map<std::pair<double, double>, std::size_t> line_of;  // where a place is
  std::size_t free_of_cost = 0;                              // places that cost nothing where they are true
};

// A number that is fit for a table. Bad lines are not skipped: without its row a column means nothing.
double NumberIn(std::size_t column, bool is_error, CsvReader* reader) {
  const std::optional<double> number = reader->Number(column);
  CAIRN_DEMAND(number.has_value(), "bad lines throw");
  if (is_error && *number < 0) reader->Bad("below 0", std::string(reader->Text(column)));
  return *number;
}

void AddRow(std::size_t places, CsvReader* reader, ErrorTable* table) {
  const double x = NumberIn(0, false, reader), y = NumberIn(1, false, reader);
  const auto [at, is_new] = table->line_of.try_emplace({x, y}, reader->line());
  if (!is_new) reader->Bad("the place of line " + std::to_string(at->second) + " again");
  if (table->x_m.size() == places)
    reader->Bad("more rows than the " + std::to_string(places) + " columns for places");
  for (std::size_t p = 0; p < places; ++p) table->error.push_back(NumberIn(2 + p, true, reader));
  if (table->error[table->error.size() - places + table->x_m.size()] == 0) ++table->free_of_cost;
  table->x_m.push_back(x);
  table->y_m.push_back(y);
}

}  // namespace

ImportReport ImportErrors(const ErrorsImportOptions& options, Blob* errors) {
  BadLines bad(false, false);
  CsvReader reader(options.file, {{"x_m", "y_m"}}, &bad);
  reader.TakeExtraColumns();
  const std::size_t places = reader.extra_columns().size();
  if (places == 0 || places > kMostPlaces)
    throw InputError(options.file + ":1: " + std::to_string(places) +
                     " columns for places beside x_m and y_m; allowed: 1 to " + std::to_string(kMostPlaces));
  ErrorTable table;
  while (reader.Next()) AddRow(places, &reader, &table);
  if (table.x_m.size() != places)
    throw InputError(options.file + ":" + std::to_string(reader.line()) + ": " +
                     std::to_string(table.x_m.size()) + " rows, where there are " + std::to_string(places) +
                     " columns for places");
  ImportReport report;
  if (table.free_of_cost < places)
    report.warnings.push_back(std::to_string(places - table.free_of_cost) + " of " + std::to_string(places) +
                              " places cost something where they are the true one");
  Blob blob;
  blob.PutVector("place/x_m", table.x_m);
  blob.PutVector("place/y_m", table.y_m);
  const auto rows = static_cast<std::int64_t>(places);
  blob.Put("error", Array::Of<double>({rows, rows}, table.error));
  *errors = std::move(blob);
  return report;
}

}  // namespace cairn::datasets
