// The interface of a method: a pipeline is cut into rounds, a round into tasks.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/job.pb.h"

namespace cairn {

using proto::State;
using proto::Task;

// What a pipeline returns when it starts or advances: the next State with its tasks, or the stage's result.
struct Step {
  proto::Step plan;
  std::vector<BlobPtr> blobs;  // new ones that the plan names by hash

  // Keeps `blob` with this step and returns its hash, as the plan's fields hold it (16 bytes).
  std::string Share(Blob blob);
};

// Says that so many rounds are expected to follow those of `plan`, whose tasks cost so much all together (as
// Task.cost: microseconds of a core) and run `width` side by side, 0: as many as there are workers. From
// sizes and the State alone, never from clocks. The coordinator makes the time left of it
// (coordinator/core/eta.h): what is not announced comes on top of what people are told.
// Where the data decide how much comes, it is so many times as much, `least` to `most`, and people are told a
// span.
void ExpectRounds(double rounds, double cost, double width, proto::Step* plan, double least = 1,
                  double most = 1);

// What a plan expects to follow it.
double RoundsLater(const proto::Step& plan);
double CostLater(const proto::Step& plan);

// Named input blobs, fetched when asked for.
class Inputs {
 public:
  virtual ~Inputs() = default;
  virtual bool Has(const std::string& name) const = 0;
  // All three throw InputError that names the input where there is none.
  virtual BlobPtr Get(const std::string& name) const = 0;
  // The same, but of fields whose names end in `but` no more than types and shapes (Array::FormAlone): of a
  // large log START and ADVANCE read this, and tasks the rest in parts.
  virtual BlobPtr GetHead(const std::string& name, const std::string& but) const;
  // Its content hash, for tasks to name.
  virtual Hash HashOf(const std::string& name) const { return Get(name)->ContentHash(); }
};

// The partials of a round, in task order.
class Partials {
 public:
  virtual ~Partials() = default;
  virtual std::size_t size() const = 0;
  // The partial of task `index`; read each one once, in order, and let it go: they need not all fit in
  // memory.
  virtual BlobPtr Get(std::size_t index) = 0;
};

// How a long computation shows that it lives.
class Progress {
 public:
  virtual ~Progress() = default;
  // Call it at least every 100 ms or so of work.
  // Throws Cancelled when the task is no longer wanted.
  virtual void Tick() = 0;
};

struct Cancelled {};  // not an error: unwinds a task that is no longer wanted

// Holds its options; const everywhere. All three run on a worker.
// All three throw InputError where the user's input is wrong, and say what is allowed.
class Pipeline {
 public:
  virtual ~Pipeline() = default;
  // Inputs: the stage's, by the pipeline's names (log, poses, map).
  virtual Step Start(const Inputs& inputs) const = 0;
  // Inputs: the task's. Pure: the same task gives the same bytes.
  virtual Blob Run(const Task& task, const Inputs& inputs, Progress& progress) const = 0;
  // Reduces in task order, then plans. Inputs: the stage's, and the state's blobs by their names there.
  virtual Step Advance(const State& state, Partials& partials, const Inputs& inputs) const = 0;
};

}  // namespace cairn
