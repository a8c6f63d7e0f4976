#include "coordinator/cli/reproduce/reproduce.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/invocation.h"
#include "coordinator/cli/common/programs.h"
#include "coordinator/cli/common/scalar.h"
#include "coordinator/cli/common/stop_signal.h"
#include "coordinator/cli/output/console.h"
#include "coordinator/cli/output/pages.h"
#include "coordinator/local/embedded.h"
#include "datasets/reproduce/landmarks/figures.h"
#include "schema/store/atomic_file.h"
#include "schema/store/blob_file.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

struct ReproduceArguments {
  std::string out = "reproduce-landmarks";
  std::uint64_t seed = 4;
  int workers = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  bool force = false;
  bool json = false;
};

std::string Facts(const std::vector<datasets::PaperFigure>& figures, const std::string& page, bool json) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  std::string text;
  for (const datasets::PaperFigure& figure : figures) {
    nlohmann::ordered_json entry = {{"file", figure.file},
                                    {"title", figure.title},
                                    {"claim", figure.claim},
                                    {"measured", figure.measured},
                                    {"holds", nullptr}};
    if (figure.holds) entry["holds"] = *figure.holds;
    if (!figure.table.head.empty())
      entry["table"] = {{"head", figure.table.head}, {"rows", figure.table.rows}};
    list.push_back(std::move(entry));
    text += figure.title + "\n    claim: " + ClaimVerdict(figure) + "\n    " + figure.measured + "\n" +
            PaperTableText(figure.table);
  }
  if (json) return nlohmann::ordered_json{{"page", page}, {"figures", list}}.dump(2) + "\n";
  return text + "page      " + page + "\n";
}

int Landmarks(const ReproduceArguments& options, const Invocation& call) {
  const datasets::LandmarkStudy study = datasets::MakeLandmarkStudy(options.seed);
  const coordinator::EmbeddedResult run =
      RunStudy({options.out, options.workers, options.force}, study.job, study.inputs, call);
  if (!IsDone(run)) return ExplainUndone(run);
  PublishPage(options.out, "A probabilistic approach to concurrent mapping and localization",
              "The figures of Thrun, Burgard and Fox (Machine Learning 31, 1998) from simulated data: paper "
              "difficulty, seed " +
                  std::to_string(options.seed) +
                  ". Occupancy grids, photographs and the museum's figures 4, 15 to 17 are not among them.",
              datasets::LandmarkFigures(study, ReadResults(run)), options.json);
  return kExitDone;
}

}  // namespace

coordinator::EmbeddedResult RunStudy(const StudyFolder& folder, const proto::Job& job,
                                     const std::map<std::string, Blob>& inputs, const Invocation& call) {
  const fs::path out = folder.out;
  TakeStudyFolder(folder.out, folder.force);
  coordinator::EmbeddedOptions embedded;
  embedded.dir = (out / "results").string();
  embedded.workers = folder.workers;
  embedded.worker_program = WorkerProgram();
  embedded.force = folder.force;
  std::map<std::string, BlobPtr> given;
  for (const auto& [name, blob] : inputs) given[name] = std::make_shared<const Blob>(blob.Without("truth/"));
  Console console(call);
  embedded.log = console.Sink();
  coordinator::EmbeddedResult run = coordinator::RunEmbedded(
      embedded, job, given,
      [&](const coordinator::EmbeddedProgress& progress) { console.Progress(progress.info); },
      StopOnSignals());
  console.Clear();
  if (!IsDone(run)) return run;
  fs::create_directories(out / "inputs");
  for (const auto& [name, blob] : inputs) {
    const char* kind = blob.Has("map/grid/probability") ? "landmark_map" : "log";
    Check(WriteBlobFile((out / "inputs" / (name + ".h5")).string(), kind, blob));
  }
  return run;
}

std::map<std::string, Blob> ReadResults(const coordinator::EmbeddedResult& run) {
  std::map<std::string, Blob> results;
  for (const auto& [stage, file] : run.results) results[stage] = Take(ReadBlobFile(file)).blob;
  return results;
}

bool IsDone(const coordinator::EmbeddedResult& run) {
  return run.end == coordinator::EmbeddedEnd::kDone || run.end == coordinator::EmbeddedEnd::kAlreadyDone;
}

int ExplainUndone(const coordinator::EmbeddedResult& run) {
  using coordinator::EmbeddedEnd;
  const bool stopped = run.end == EmbeddedEnd::kStopped;
  const std::string conflict = run.end == EmbeddedEnd::kConflict ? " (--force starts anew)" : "";
  std::fprintf(stderr, "cairn: %s%s\n",
               stopped ? "stopped; the same command again goes on from here" : run.reason.c_str(),
               conflict.c_str());
  if (stopped) return kExitStopped;
  const bool world = run.end == EmbeddedEnd::kFailed || run.end == EmbeddedEnd::kPaused;
  return world ? kExitFailed : kExitBadInput;
}

void PublishPage(const std::string& out, const std::string& title, const std::string& lead,
                 const std::vector<datasets::PaperFigure>& figures, bool json) {
  for (const datasets::PaperFigure& figure : figures) {
    if (!figure.file.empty()) Check(WriteTextAtomically((fs::path(out) / figure.file).string(), figure.png));
  }
  const std::string page = (fs::path(out) / "index.html").string();
  Check(WriteTextAtomically(page, datasets::PaperPageHtml(title, lead, figures)));
  std::fputs(Facts(figures, page, json).c_str(), stdout);
}

void AddReproduce(Command app, Invocation& call) {
  Command landmarks;
  const auto options = AddCommand<ReproduceArguments>(
      app, call, "landmarks", "Figures 1 to 3, 5 to 14 and 18 on landmark maps, from simulated data",
      "cairn-reproduce landmarks --out figures", Landmarks, &landmarks);
  landmarks.Add("--out", options->out, "Folder of page, pictures, logs (inputs/) and results (results/)")
      .ShowDefault();
  landmarks.Add("--seed", options->seed, "Of the simulated worlds").Check(CheckSeed).ShowDefault();
  landmarks.Add("--workers", options->workers, "Worker processes (as many as there are cores)")
      .Within(1, 1024);
  landmarks.AddFlag("--force", options->force, "Forget what an earlier run left in the folder");
  landmarks.AddFlag("--json", options->json, "Pictures, claims and measured figures as JSON");
  AddReproduceBall(app, call);
  AddReproduceOccupancy(app, call);
  AddReproduceLocal(app, call);
}

}  // namespace cairn::cli
