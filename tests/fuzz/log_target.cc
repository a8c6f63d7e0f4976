// Logs and results in which a few fields are not as they should be.
#include <filesystem>
#include <map>
#include <utility>

#include "datasets/evaluate/evaluate.h"
#include "datasets/export/export.h"
#include "datasets/kinds/job_report.h"
#include "datasets/report/draw_map.h"
#include "pipelines/testing/in_process.h"
#include "schema/kinds/kind.h"
#include "schema/numerics.h"
#include "tests/conformance/cases.h"
#include "tests/fuzz/byte_source.h"
#include "tests/fuzz/scramble.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/targets.h"

namespace cairn::fuzz {
namespace {

// A registered pipeline's case, with its result: computed once.
struct Good {
  conformance::Case c;
  BlobPtr log, result;
};

const std::vector<Good>& Goods() {
  static const std::vector<Good> goods = [] {
    FixNumericsOfProcess();
    FixNumericsOfThread();
    std::vector<Good> made;
    for (const conformance::Case& c : conformance::AllCases()) {
      if (c.stage.pipeline() != "landmark_map") continue;
      made.push_back({c, c.inputs.at("log"), RunInProcess(*conformance::Make(c.stage, c.seed), c.inputs)});
    }
    return made;
  }();
  return goods;
}

// A case's inputs, its log replaced.
class OtherLog : public Inputs {
 public:
  OtherLog(const conformance::Case& c, BlobPtr log) : inputs_(c.inputs) { inputs_["log"] = std::move(log); }
  bool Has(const std::string& name) const override { return inputs_.contains(name); }
  BlobPtr Get(const std::string& name) const override {
    if (!Has(name)) throw InputError("there is no input '" + name + "'");
    return inputs_.at(name);
  }

 private:
  std::map<std::string, BlobPtr> inputs_;
};

// True where it did not refuse.
template <class Function>
bool Accepts(Function function) {
  try {
    function();
  } catch (const InputError&) {
    return false;
  }
  return true;
}

const std::string& Folder() {
  static const ScratchFolder folder;
  static const std::string name = (folder.path() / "exported").string();
  return name;
}

void Ignore(const datasets::Written& written) { static_cast<void>(written); }

Outcome RunLog(std::span<const std::uint8_t> bytes) {
  ByteSource source(bytes);
  const Good& good = Goods()[source.Below(Goods().size())];
  const std::size_t what = source.Below(4);
  const Blob log = Scrambled(*good.log, &source);
  bool accepted = false;
  if (what == 0)
    accepted = Accepts([&] {
      const OtherLog input(good.c, std::make_shared<const Blob>(log.Without("truth/")));
      conformance::Make(good.c.stage, good.c.seed)->Start(input);
    });
  const bool fits = Accepts([&] { CheckKind(log, "log"); });  // as commands do that read one
  if (what == 1) accepted = fits && Accepts([&] { datasets::Evaluate(*good.result, log); });
  if (what == 2)
    accepted = fits && Accepts([&] {
                 datasets::JobReportHtml({{.name = "map", .result = good.result.get(), .source = &log}});
               });
  if (what == 3)
    accepted = fits && Accepts([&] {
                 Ignore(datasets::ExportCsv(log, Folder()));
                 Ignore(datasets::ExportTum(log, Folder()));
                 Ignore(datasets::ExportMcap(log, Folder()));
                 Ignore(datasets::ExportG2o(*good.result, &log, Folder()));
               });
  return accepted ? Outcome::kAccepted : Outcome::kRefused;
}

Outcome RunResult(std::span<const std::uint8_t> bytes) {
  ByteSource source(bytes);
  const Good& good = Goods()[source.Below(Goods().size())];
  const std::size_t what = source.Below(4);
  const Blob result = Scrambled(*good.result, &source);
  bool accepted = false;
  if (!Accepts([&] { CheckKind(result, "landmark_map"); })) return Outcome::kRefused;
  if (what == 0) accepted = Accepts([&] { datasets::Evaluate(result, *good.log); });
  if (what == 1)
    accepted = Accepts(
        [&] { datasets::JobReportHtml({{.name = "map", .result = &result, .source = good.log.get()}}); });
  if (what == 2) accepted = Accepts([&] { datasets::DrawMapPng(result, good.log.get(), nullptr, 400); });
  if (what == 3)
    accepted = Accepts([&] {
      Ignore(datasets::ExportCsv(result, Folder()));
      Ignore(datasets::ExportTum(result, Folder()));
      Ignore(datasets::ExportEuroc(result, Folder()));
      Ignore(datasets::ExportPly(result, Folder()));
      Ignore(datasets::ExportGeojson(result, {48, 11, 30}, Folder()));
      for (const auto mode :
           {datasets::RosMode::kTrinary, datasets::RosMode::kScale, datasets::RosMode::kRaw})
        Ignore(datasets::ExportRos(result, Folder(), true, mode));
      Ignore(datasets::ExportMcap(result, Folder()));
      Ignore(datasets::ExportOctomap(result, Folder()));
      Ignore(datasets::ExportG2o(result, good.log.get(), Folder()));
    });
  return accepted ? Outcome::kAccepted : Outcome::kRefused;
}

std::vector<Bytes> Seeds() {
  std::vector<Bytes> seeds;
  for (std::uint8_t which = 0; which < Goods().size(); ++which)
    for (std::uint8_t what = 0; what < 4; ++what) seeds.push_back({which, what, 0});
  return seeds;
}

}  // namespace

Target LogTarget() { return {"log", RunLog, Seeds, 300}; }
Target ResultTarget() { return {"result", RunResult, Seeds, 200}; }

}  // namespace cairn::fuzz
