// What Cairn does with each kind of result: one table, a row a kind. A new kind is a row here and one in
// schema/kinds/kind.cc.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "datasets/evaluate/evaluate.h"
#include "datasets/evaluate/grid.h"
#include "datasets/evaluate/learning/localization.h"
#include "datasets/evaluate/learning/networks.h"
#include "datasets/evaluate/local.h"
#include "datasets/verdicts/verdict.h"
#include "schema/blob.h"

namespace cairn::datasets {

// What evaluating a result of any kind gives.
using Evaluated =
    std::variant<Evaluation, GridEvaluation, LocalEvaluation, LocalizationScore, NetworkEvaluation>;

inline Scores MakeScores(const Evaluated& evaluated) {
  return std::visit([](const auto& evaluation) { return MakeScores(evaluation); }, evaluated);
}

// A stage of a job on its page: its result, what it was made from, and how good it is. `source` (the log,
// with or without truth; of networks and of a localization the samples) may be null: without a log there is
// no raw odometry, without an evaluation no truth.
struct ReportedStage {
  std::string name;
  const Blob* result = nullptr;
  const Blob* source = nullptr;
  std::optional<Evaluated> evaluated = {};
};

// A function that is null: there is no such thing of the kind.
struct ResultKind {
  std::string_view name;
  bool is_map = false;  // people look for it in the folder of a job
  // "log" or "samples": what it is held against, and what its page needs for more.
  std::string_view made_of = {};
  // Whether what it is made of tells how good it is. Null: it does not, or the page asks for itself.
  bool (*has_truth)(const Blob& source) = nullptr;
  // Throws InputError where the truth is another's, or does not tell.
  Evaluated (*evaluate)(const Blob& result, const Blob& truth, const ScoreOptions& options) = nullptr;
  bool compares = false;  // with another result of its kind, too
  bool takes_score_options = false;
  bool page_takes_source = true;
  std::string (*page)(const ReportedStage& stage) = nullptr;  // the HTML between title and footer
  std::string (*picture)(const ReportedStage& stage, int width_px) = nullptr;  // a PNG file
  Scores (*summary)(const Blob& result) = nullptr;                             // what was found
  Verdict (*verdict)(const Blob& result) = nullptr;                            // how far to trust it
  std::string_view exports = {};  // the formats of `cairn export` that it can be written in
  bool tells_free_space = false;  // so that ways can be planned in it
};

// In the order in which a folder's results are looked for.
std::span<const ResultKind> ResultKinds();

// Null where no row is of that name.
const ResultKind* FindResultKind(std::string_view name);

}  // namespace cairn::datasets
