// What the conformance suite runs over: every registered pipeline, and the toy, each with small inputs of its
// own.
#pragma once

#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "pipelines/pipeline.h"
#include "pipelines/registry.h"
#include "schema/job.pb.h"

namespace cairn::conformance {

using InputMap = std::map<std::string, BlobPtr>;

struct Case {
  std::string name;    // the pipeline's, and what is particular
  proto::Stage stage;  // with options that cut the fixture into several rounds of several tasks
  std::uint64_t seed = 7;
  InputMap inputs;
  std::size_t rounds = 2;  // as many as the fixture has, or more
  std::size_t tasks = 3;   // at least so many in the largest round
};

// For GoogleTest, which would print the bytes.
inline void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

// A registered pipeline without a fixture has no inputs here, and fails the first test of the suite.
std::vector<Case> AllCases();

// Robots that go round one square of 6 m `laps` times each: they see its corners, which have names, or press
// a button at each.
Case SquareDrive(const std::string& name, bool ranged, int robots, int laps = 3);

// MakePipeline of the registry, and the toy.
std::unique_ptr<const Pipeline> Make(const proto::Stage& stage, std::uint64_t seed);
// What --describe of the suite's worker says.
std::vector<PipelineInfo> ListAll();

// The names under which a job finds a case's inputs: each is called what the pipeline calls it.
proto::Job JobOf(const Case& c);

}  // namespace cairn::conformance
