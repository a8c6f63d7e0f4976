// A fixture for tests of a service that has keys: a list of a few of them, and clients that each show one.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include "coordinator/server/testing/hub_fixture.h"
#include "schema/wire/keys.h"

namespace cairn::coordinator {

class RightsFixture : public ::testing::Test {
 protected:
  RightsFixture() {
    Allow(worker_ + " worker\n" + other_ + " worker\n" + submitter_ + " submitter\n" + viewer_ + " viewer\n");
    fixture_.allow_list = fixture_.temp.path() / "allowed";
    fixture_.Start();
  }
  void Allow(const std::string& lines) {
    const std::filesystem::path list = fixture_.temp.path() / "allowed";
    std::ofstream(list.string() + ".new") << lines << "end\n";
    std::filesystem::rename(list.string() + ".new", list);
  }
  // The answer that `user` gets. Who waits for an upload on a slow disk hears in between that we are still
  // there.
  wire::Envelope Ask(const std::string& user, wire::Message question) {
    const std::string peer = "peer of " + user;
    fixture_.transport.Come(peer, std::move(question), user);
    wire::Envelope answer;
    fixture_.Until([&] {
      for (auto it = fixture_.transport.sent.begin(); it != fixture_.transport.sent.end(); ++it) {
        const bool still_there =
            it->second.envelope.has_credit() && it->second.envelope.credit().bytes() == 0;
        if (it->first != peer || still_there) continue;
        answer = it->second.envelope;
        fixture_.transport.sent.erase(it);
        return true;
      }
      return false;
    });
    return answer;
  }
  void ExpectRefused(const std::string& user, const wire::Message& question, wire::RefusalKind kind) {
    const std::uint64_t before = Count(kind);
    const wire::Envelope answer = Ask(user, question);
    EXPECT_TRUE(answer.has_refuse()) << wire::KindName(question.envelope) << ": "
                                     << answer.ShortDebugString();
    EXPECT_EQ(Count(kind), before + 1) << wire::KindName(question.envelope);
    EXPECT_EQ(answer.refuse().reason().find(user), std::string::npos) << "the whole key is shown";
  }
  std::uint64_t Count(wire::RefusalKind kind) const { return fixture_.server->refusals().count(kind); }
  void Join(const std::string& peer, const std::string& user, std::uint64_t process) {
    fixture_.transport.users[peer] = user;
    fixture_.transport.ComeWorker(peer, user, 1, process);  // in a container each has the same process id
  }
  bool Connected(const std::string& peer) const { return fixture_.server->core().fleet().Knows(peer); }
  wire::Message Query(const std::string& action, const std::string& job = "a") {
    wire::Message message;
    message.envelope.mutable_query()->set_job(job);
    message.envelope.mutable_query()->set_action(action);
    return message;
  }
  void Bring() {
    EXPECT_TRUE(fixture_.Upload(TextBlob("the log"), "peer of " + submitter_, submitter_).ok());
  }
  wire::Message Submission() { return fixture_.Submission(fixture_.MakeJob(), false); }

  const std::string worker_ = wire::GenerateKeyPair().public_key, other_ = wire::GenerateKeyPair().public_key,
                    submitter_ = wire::GenerateKeyPair().public_key,
                    viewer_ = wire::GenerateKeyPair().public_key,
                    stranger_ = wire::GenerateKeyPair().public_key;
  ServerFixture fixture_;
};

}  // namespace cairn::coordinator
