// How often each kind of fault and each of the core's transitions came up, so that the simulator cannot
// silently stop exercising one: a test asks that every mark is met.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace cairn::simulation {

// Name in the code, and for people.
#define CAIRN_SIM_MARKS(X)                                                   \
  X(kMessageLost, "network: a message is lost")                              \
  X(kMessageDoubled, "network: a message comes twice")                       \
  X(kMessageLate, "network: a message comes seconds late")                   \
  X(kMessageOvertaken, "network: a message overtakes another")               \
  X(kCutOff, "network: a worker is cut off")                                 \
  X(kCutOneWay, "network: a worker is cut off in one direction")             \
  X(kMessageCut, "network: a message into a partition")                      \
  X(kFetchDamaged, "network: a blob comes damaged, and is not taken")        \
  X(kPartFetched, "worker: is sent a part of a blob")                        \
  X(kFetchedAgain, "worker: asks again for what has not come")               \
  X(kBlobMissing, "worker: is told that what it asks for is not there")      \
  X(kWorkerKilled, "worker: killed at some moment")                          \
  X(kWorkerKilledAtMessage, "worker: killed as a message comes")             \
  X(kWorkerKilledBeforeAnswer, "worker: killed before it answers")           \
  X(kWorkerKilledAfterAnswer, "worker: killed after it answered")            \
  X(kWorkerLeft, "worker: leaves")                                           \
  X(kWorkerTerminated, "worker: told to end, drains")                        \
  X(kWorkerDrained, "worker: has drained, and leaves")                       \
  X(kWorkerHung, "worker: hangs, heartbeats go on")                          \
  X(kWorkerUnhung, "worker: goes on after it hung")                          \
  X(kWorkerStopped, "worker: stopped as a whole")                            \
  X(kWorkerSlow, "worker: slow")                                             \
  X(kWorkerBroken, "worker: its connection breaks, and it comes back")       \
  X(kWorkerOtherBuild, "worker: of another build")                           \
  X(kWorkerLateJoiner, "worker: joins late")                                 \
  X(kWorkerForgot, "worker: forgets its tasks")                              \
  X(kWorkerClockForward, "worker: its clock jumps forward")                  \
  X(kWorkerClockBackward, "worker: its clock jumps backward")                \
  X(kTaskTrouble, "worker: a task fails")                                    \
  X(kLieNoBlob, "lie: an answer without its blob")                           \
  X(kLieWrongHash, "lie: a blob that its hash does not name")                \
  X(kLieWrongShape, "lie: an answer of a wrong shape")                       \
  X(kLieNotTheirs, "lie: an answer to a task that was never theirs")         \
  X(kLieNotTheirsFailed, "lie: a failure of a task that was never theirs")   \
  X(kLieHeartbeat, "lie: a heartbeat about tasks that were never theirs")    \
  X(kLiePlausible, "lie: a wrong answer of the right shape")                 \
  X(kLieSecond, "lie: a second answer that differs")                         \
  X(kLieBelieved, "lie: believed, as nothing contradicts it")                \
  X(kLieFoundOut, "lie: found out by two answers that differ")               \
  X(kCoordinatorKilled, "coordinator: killed")                               \
  X(kCoordinatorKilledAtAction, "coordinator: killed between two actions")   \
  X(kCoordinatorKilledWriting, "coordinator: killed while it writes")        \
  X(kPowerCut, "coordinator: power cut")                                     \
  X(kPowerCutAtStart, "coordinator: power cut just after a start")           \
  X(kCoordinatorStalled, "coordinator: stopped for a while")                 \
  X(kClockForward, "coordinator: its clock jumps forward")                   \
  X(kClockBackward, "coordinator: its clock jumps backward")                 \
  X(kDiskFull, "disk: full, a write fails")                                  \
  X(kSyncFailed, "disk: an fsync fails")                                     \
  X(kFolderSyncFailed, "disk: a folder's fsync fails, the file is there")    \
  X(kUnsyncedLost, "disk: what was not synced is gone")                      \
  X(kUnsyncedKept, "disk: what was not synced is there all the same")        \
  X(kCheckpointDamaged, "disk: a checkpoint is damaged")                     \
  X(kBlobDamaged, "disk: a checkpoint's blob is damaged")                    \
  X(kQuarantined, "store: a checkpoint is quarantined, the one before used") \
  X(kDurableUntold, "store: durable, but the core was never told")           \
  X(kRestoredWithPartials, "store: a round goes on from saved partials")     \
  X(kSubmitted, "user: submits")                                             \
  X(kSubmittedTwice, "user: submits the same again")                         \
  X(kSubmittedHopeless, "user: submits a job that cannot be")                \
  X(kUploaded, "client: has brought an input in pieces")                     \
  X(kUploaderKilled, "client: killed while it brings an input")              \
  X(kUploaderStopped, "client: stands still while it brings an input")       \
  X(kUploaderCheated, "client: sends more than it may")                      \
  X(kUploaderDropped, "client: dropped, for it sent more than it may")       \
  X(kUploadGivenUp, "upload: given up, as nothing comes of it")              \
  X(kUploadRefused, "upload: refused, as the disk fails")                    \
  X(kCancelled, "user: cancels what runs")                                   \
  X(kCancelledPaused, "user: cancels what is paused")                        \
  X(kCancelledUnsaved, "user: cancels before the job is durable")            \
  X(kResumed, "user: resumes")                                               \
  X(kHeld, "user: pauses")                                                   \
  X(kRetried, "user: retries")                                               \
  X(kPrioritized, "user: gives another priority")                            \
  X(kDeleted, "user: deletes what has ended")                                \
  X(kAcknowledged, "user: is told that it is done")                          \
  X(kSubmissionRefused, "user: is refused a job that cannot be saved")       \
  X(kTakenBack, "user: is refused a command that cannot be saved")           \
  X(kDeletionRefused, "user: is refused a deletion that fails")              \
  X(kDrainedByUser, "user: drains a worker")                                 \
  X(kSavedNow, "user: asks to save now")                                     \
  X(kRoundEnded, "core: a round ends")                                       \
  X(kStageEnded, "core: a stage ends")                                       \
  X(kPaused, "core: running -> paused")                                      \
  X(kDone, "core: running -> done")                                          \
  X(kFailed, "core: running -> failed")                                      \
  X(kFailedPaused, "core: paused -> failed")                                 \
  X(kCancelledJob, "core: running -> cancelled")                             \
  X(kCancelledFromPause, "core: paused -> cancelled")                        \
  X(kWokePaused, "core: paused -> running")                                  \
  X(kWokeFailed, "core: failed -> running")                                  \
  X(kInputError, "core: a job fails by its input")                           \
  X(kThirdFailure, "core: a job fails by a task's third failure")            \
  X(kAttemptAgain, "core: a task is dispatched again")                       \
  X(kBlameTakenBack, "core: takes back the blame for a lost connection")     \
  X(kLostWithNode, "core: counts a task as lost with its machine")           \
  X(kStoodStill, "core: finds that it stood still, with workers there")      \
  X(kCopied, "core: a straggler is copied")                                  \
  X(kExcluded, "core: excludes a worker for a malformed answer")             \
  X(kExcludedAlone, "core: a excluded worker serves, as nobody else does")   \
  X(kStaleAnswer, "core: an answer to what is past")                         \
  X(kSecondAnswer, "core: a second answer, the same")                        \
  X(kWelcome, "core sends Welcome")                                          \
  X(kRefuse, "core sends Refuse")                                            \
  X(kUnknownWorker, "core sends UnknownWorker")                              \
  X(kAssign, "core sends Assign")                                            \
  X(kCancel, "core sends Cancel")                                            \
  X(kDrain, "core sends Drain")                                              \
  X(kDrainedOfQueued, "core: what a draining worker has queued moves")       \
  X(kPersist, "core asks to save")                                           \
  X(kDrop, "core drops blobs")

enum Mark : std::size_t {
#define CAIRN_SIM_MARK(mark, text) mark,
  CAIRN_SIM_MARKS(CAIRN_SIM_MARK)
#undef CAIRN_SIM_MARK
      kMarks
};

inline constexpr std::array<const char*, kMarks> kMarkTexts = {
#define CAIRN_SIM_MARK(mark, text) text,
    CAIRN_SIM_MARKS(CAIRN_SIM_MARK)
#undef CAIRN_SIM_MARK
};

using Coverage = std::array<std::uint64_t, kMarks>;

}  // namespace cairn::simulation
