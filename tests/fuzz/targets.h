// What is fuzzed: bytes go in, and whatever they are, nothing may crash, leak, hang or contradict itself.
// Each target aborts where it does.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace cairn::fuzz {

using Bytes = std::vector<std::uint8_t>;

enum class Outcome { kRefused, kAccepted };

struct Target {
  std::string name;
  Outcome (*run)(std::span<const std::uint8_t> bytes);
  std::vector<Bytes> (*seeds)();  // each of them is accepted
  int short_runs;                 // of mutations, in fuzz_test
};

// The first byte chooses which file of an import (odometry, observations, three of truth) the others are,
// whether bad lines are skipped, and whether the file is gzipped first; the other files are good ones. An
// accepted log has columns of equal length, finite numbers and times in order.
Target CsvTarget();
// The same of a folder of MRCLAM's.
Target MrclamTarget();
// A CARMEN log; the first byte chooses as above, whether lines are numbered, and what its poses are taken
// for. An accepted log has finite numbers, times in order, ranges within reach and a table of poses at times
// of their own.
Target CarmenTarget();
// The other range logs, trajectories and relations; the first byte also chooses the reader.
Target RangesTarget();
// A bag of any container; the first byte chooses what is skipped and asked for. An accepted log as above.
Target BagTarget();
// The same without what is made of its messages; the first byte chooses whose are read.
Target BagContainerTarget();
// A definition, after its length in two bytes, and a message of it, in the encoding that the first byte
// chooses.
Target BagMessageTarget();
// A run of samples, alone or after a good one; the first byte chooses as above. Accepted samples are runs of
// finite numbers and times in order.
Target VectorsTarget();
// A job file.
Target JobFileTarget();
// Key pairs, public keys, lists of those allowed.
Target KeysTarget();

// A message as it comes from a socket: frames, each after its length in two bytes, little-endian. An accepted
// one is encoded and decoded again, and must be the same.
Target MessageTarget();
// What workers and clients say to a coordinator, as a session: right, wrong at some place, or any bytes. The
// store that is left can be read by the next coordinator.
Target CoordinatorTarget();
// What a coordinator says to a worker, as a session.
Target WorkerTarget();

// The bytes of a Cairn file, read by HDF5. An accepted blob is written again and read again, and must be the
// same.
Target BlobFileTarget();
// The bytes of a file of a store: HDF5 sees those only that were written.
Target StoredFileTarget();
// The bytes inside a checkpoint; the core takes up what is accepted and goes on with it.
Target CheckpointTarget();
// A job table.
Target JobTableTarget();
// A log, and a result, with some fields changed: planned with, evaluated, exported, drawn.
Target LogTarget();
Target ResultTarget();

std::vector<Target> AllTargets();

}  // namespace cairn::fuzz
