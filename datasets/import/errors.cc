#include "datasets/import/errors.h"

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "datasets/import/csv_reader.h"
#include "schema/error.h"

namespace cairn::datasets {
namespace {

constexpr std::size_t kMostPositions = 4096;

struct ErrorTable {
  std::vector<double> x_m, y_m, error;
  std::map<std::pair<double, double>, std::size_t> line_of;  // where a position is
  std::size_t free_of_cost = 0;  // positions that cost nothing where they are true
};

// A number that is fit for a table. Bad lines are not skipped: without its row a column means nothing.
double NumberIn(std::size_t column, bool is_error, CsvReader* reader) {
  const std::optional<double> number = reader->Number(column);
  CAIRN_DEMAND(number.has_value(), "bad lines throw");
  if (is_error && *number < 0) reader->Bad("below 0", std::string(reader->Text(column)));
  return *number;
}

void AddRow(std::size_t positions, CsvReader* reader, ErrorTable* table) {
  const double x = NumberIn(0, false, reader), y = NumberIn(1, false, reader);
  const auto [at, is_new] = table->line_of.try_emplace({x, y}, reader->line());
  if (!is_new) reader->Bad("the position of line " + std::to_string(at->second) + " again");
  if (table->x_m.size() == positions)
    reader->Bad("more rows than the " + std::to_string(positions) + " columns for positions");
  for (std::size_t p = 0; p < positions; ++p) table->error.push_back(NumberIn(2 + p, true, reader));
  if (table->error[table->error.size() - positions + table->x_m.size()] == 0) ++table->free_of_cost;
  table->x_m.push_back(x);
  table->y_m.push_back(y);
}

}  // namespace

ImportReport ImportErrors(const ErrorsImportOptions& options, Blob* errors) {
  BadLines bad(false, false);
  CsvReader reader(options.file, {{"x_m", "y_m"}}, &bad);
  reader.TakeExtraColumns();
  const std::size_t positions = reader.extra_columns().size();
  if (positions == 0 || positions > kMostPositions)
    throw InputError(reader.Place() + std::to_string(positions) +
                     " columns for positions beside x_m and y_m; allowed: 1 to " +
                     std::to_string(kMostPositions));
  ErrorTable table;
  while (reader.Next()) AddRow(positions, &reader, &table);
  if (table.x_m.size() != positions)
    throw InputError(options.file + ":" + std::to_string(reader.line()) + ": " +
                     std::to_string(table.x_m.size()) + " rows, where there are " +
                     std::to_string(positions) + " columns for positions");
  ImportReport report;
  if (table.free_of_cost < positions)
    report.warnings.push_back(std::to_string(positions - table.free_of_cost) + " of " +
                              std::to_string(positions) +
                              " positions cost something where they are the true one");
  Blob blob;
  blob.PutVector("position/x_m", table.x_m);
  blob.PutVector("position/y_m", table.y_m);
  const auto rows = static_cast<std::int64_t>(positions);
  blob.Put("error", Array::Of<double>({rows, rows}, table.error));
  *errors = std::move(blob);
  return report;
}

}  // namespace cairn::datasets
