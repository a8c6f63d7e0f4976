// What the commands under `cairn-reproduce` share: a job run embedded, and the page that comes of its
// results.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "coordinator/cli/common/invocation.h"
#include "coordinator/local/embedded.h"
#include "datasets/reproduce/paper_figure.h"

namespace cairn::cli {

struct StudyFolder {
  std::string out;  // of results/, inputs/ and the page
  int workers;
  bool force;
};

// Runs a study's job on all of its inputs, without their truth, with its progress on the terminal. Where it
// is done, the inputs stand beside the results, so that each can be made again by hand.
coordinator::EmbeddedResult RunStudy(const StudyFolder& folder, const proto::Job& job,
                                     const std::map<std::string, Blob>& inputs, const Invocation& call);

// Reads the results of a run that is done.
std::map<std::string, Blob> ReadResults(const coordinator::EmbeddedResult& run);

bool IsDone(const coordinator::EmbeddedResult& run);

// Says on stderr why a run is not done, and returns the exit code for it.
int ExplainUndone(const coordinator::EmbeddedResult& run);

// Writes pictures and OUT/index.html, and prints the figures.
void PublishPage(const std::string& out, const std::string& title, const std::string& lead,
                 const std::vector<datasets::PaperFigure>& figures, bool json);

// The commands of cairn-reproduce.
void AddReproduce(Command app, Invocation& call);
void AddReproduceBall(Command reproduce, Invocation& call);
void AddReproduceLocal(Command reproduce, Invocation& call);
void AddReproduceOccupancy(Command reproduce, Invocation& call);

}  // namespace cairn::cli
