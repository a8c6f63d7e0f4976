// A cluster that says what the test tells it to; tests/end_to_end/kubernetes.sh has a real one.
#include "coordinator/scale/engines/kubernetes_engine.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace cairn::coordinator {
namespace {

using nlohmann::json;

struct Kubectl {
  ProgramOutput Run(const Program& program) {
    asked.push_back(program);
    const std::string& verb = program.words.at(2);
    if (!answers[verb].empty()) {
      const ProgramOutput answer = answers[verb].front();
      if (answers[verb].size() > 1) answers[verb].erase(answers[verb].begin());
      return answer;
    }
    return Well("");
  }
  KubernetesEngine Engine(const KubernetesOptions& options) {
    return KubernetesEngine(options, [this](const Program& program) { return Run(program); });
  }
  // It shows these pods from now on.
  void Has(const json& pods) { answers["get"] = {Well(json{{"kind", "List"}, {"items", pods}}.dump())}; }
  static ProgramOutput Well(const std::string& out) { return {0, out, "", ""}; }

  std::vector<Program> asked;
  std::map<std::string, std::vector<ProgramOutput>> answers;  // by verb; the last again and again
};

KubernetesOptions ThePods() {
  KubernetesOptions options;
  options.kubectl = {"kubectl", "--namespace=maps"};
  options.pod_template = DefaultPodTemplate();
  options.template_file = "the template";
  options.keys = testing::TempDir() + "/kubernetes_keys." + std::to_string(::getpid());
  options.pod = {.label = "w",
                 .image = "registry.example/cairn:7",
                 .options = {"--connect", "tcp://hub:7017"},
                 .keyed = true,
                 .drain_s = 100};
  std::filesystem::create_directories(options.keys);
  for (const char* name : {"w-12.key", "w-13.key", "coordinator.pub"})
    std::ofstream(options.keys + "/" + name) << "the key of " << name << "\n";
  return options;
}

json Pod(const std::string& name, const std::string& phase, const json& more = json::object()) {
  json status = more;
  status["phase"] = phase;
  return {{"metadata", {{"name", name}}}, {"spec", {{"nodeName", "n1"}}}, {"status", status}};
}
json Ended(const json& terminated) {
  return {
      {"containerStatuses", json::array({{{"name", "worker"}, {"state", {{"terminated", terminated}}}}})}};
}
EngineWorker Read(const json& pod) {
  EngineWorker worker;
  EXPECT_TRUE(ReadPod(pod, &worker));
  return worker;
}

TEST(KubernetesEngine, MakesPodsOfItsTemplateAndASecretOfEach) {
  Kubectl kubectl;
  kubectl.answers["create"] = {Kubectl::Well("w-12 u-12\nw-13 u-13\n"), Kubectl::Well("secret/w-12\n")};
  KubernetesEngine engine = kubectl.Engine(ThePods());
  EXPECT_EQ(engine.Start({"w-12", "w-13"}).names, (std::vector<std::string>{"w-12", "w-13"}));
  ASSERT_EQ(kubectl.asked.size(), 2U);
  EXPECT_EQ(kubectl.asked[0].words[1], "--namespace=maps");
  const json pods = json::parse(kubectl.asked[0].input), secrets = json::parse(kubectl.asked[1].input);
  ASSERT_EQ(pods["items"].size(), 2U);
  const json& pod = pods["items"][1];
  EXPECT_EQ(pod["metadata"]["name"], "w-13");
  EXPECT_EQ(pod["metadata"]["labels"]["cairn-scale"], "w");
  EXPECT_EQ(pod["metadata"]["labels"]["app.kubernetes.io/part-of"], "cairn") << "what the template has stays";
  EXPECT_EQ(pod["spec"]["terminationGracePeriodSeconds"], 115);
  const json& worker = pod["spec"]["containers"][0];
  EXPECT_EQ(worker["image"], "registry.example/cairn:7");
  EXPECT_EQ(pod["spec"]["initContainers"][0]["image"], "registry.example/cairn:7");
  EXPECT_EQ(worker["args"], (json{"--connect", "tcp://hub:7017", "--name", "w-13", "--key",
                                  "/keys/own/worker.key", "--server-key", "/keys/own/coordinator.pub"}));
  EXPECT_EQ(worker["resources"]["limits"]["cpu"], "1") << "a text, as it is written";
  EXPECT_EQ(pod["spec"]["securityContext"]["runAsUser"], 10001);
  EXPECT_EQ(pod["spec"]["volumes"][0]["secret"]["secretName"], "w-13");
  const json& secret = secrets["items"][1];
  EXPECT_EQ(secret["kind"], "Secret");
  EXPECT_EQ(secret["metadata"]["name"], "w-13");
  EXPECT_EQ(secret["metadata"]["ownerReferences"][0]["uid"], "u-13") << "it goes with its pod";
  EXPECT_EQ(secret["stringData"]["worker.key"], "the key of w-13.key\n");
  EXPECT_EQ(secret["stringData"]["coordinator.pub"], "the key of coordinator.pub\n");
}

TEST(KubernetesEngine, OfManyThatAreAskedForItSaysWhichBegan) {
  Kubectl kubectl;
  const std::string quota =
      R"(Error from server (Forbidden): error when creating "STDIN": pods "w-12" is forbidden: exceeded quota)";
  kubectl.answers["create"] = {{1, "w-13 u-13\n", "x", "kubectl: " + quota}, Kubectl::Well("secret/w-13\n")};
  KubernetesEngine engine = kubectl.Engine(ThePods());
  const Engine::Started started = engine.Start({"w-12", "w-13"});
  EXPECT_EQ(started.names, std::vector<std::string>{"w-13"});
  EXPECT_EQ(started.status.message(), "kubectl: " + quota);
  EXPECT_EQ(json::parse(kubectl.asked.at(1).input)["items"].size(), 1U) << "no key of one that is not there";
}

TEST(KubernetesEngine, APodWithoutItsKeyIsNotLeft) {
  Kubectl kubectl;
  kubectl.answers["create"] = {Kubectl::Well("w-12 u-12\n"), {1, "", "x", "kubectl: secrets is forbidden"}};
  KubernetesEngine engine = kubectl.Engine(ThePods());
  const Engine::Started started = engine.Start({"w-12"});
  EXPECT_TRUE(started.names.empty());
  EXPECT_EQ(started.status.message(), "kubectl: secrets is forbidden");
  const std::vector<std::string>& last = kubectl.asked.back().words;
  EXPECT_EQ(last.at(2), "delete");
  EXPECT_EQ(last.back(), "w-12");
}

TEST(KubernetesEngine, ReadsWhatAPodIsAndWhyItWaitsOrHasEnded) {
  using State = EngineWorker::State;
  EngineWorker worker = Read(Pod("w-1", "Running"));
  EXPECT_EQ(worker.state, State::kRuns);
  EXPECT_EQ(worker.where, "n1");
  const json full = {{"type", "PodScheduled"},
                     {"status", "False"},
                     {"reason", "Unschedulable"},
                     {"message", "0/3 nodes are available: 3 Insufficient cpu."}};
  worker = Read(Pod("w-1", "Pending", {{"conditions", json::array({full})}}));
  EXPECT_EQ(worker.state, State::kWaiting);
  EXPECT_EQ(worker.why, "Unschedulable: 0/3 nodes are available: 3 Insufficient cpu.");
  const auto waits = [](const char* reason) {
    const json waiting = {{"state", {{"waiting", {{"reason", reason}, {"message", "of x"}}}}}};
    return Read(Pod("w-1", "Pending", {{"initContainerStatuses", json::array({waiting})}}));
  };
  EXPECT_EQ(waits("ErrImagePull").state, State::kWaiting) << "a registry may be away for a moment";
  EXPECT_EQ(waits("ImagePullBackOff").state, State::kEnded) << "nothing comes of that one";
  EXPECT_EQ(waits("ImagePullBackOff").why, "ImagePullBackOff: of x");

  worker = Read(Pod("w-1", "Succeeded", Ended({{"exitCode", 0}, {"reason", "Completed"}})));
  EXPECT_EQ(worker.state, State::kEnded);
  EXPECT_EQ(worker.why, "") << "as it was told";
  worker = Read(Pod("w-1", "Failed", Ended({{"exitCode", 137}, {"reason", "OOMKilled"}})));
  EXPECT_EQ(worker.state, State::kEnded);
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "OOMKilled: it took more memory than its container may",
                      worker.why);
  const json refused = {
      {"exitCode", 2}, {"reason", "Error"}, {"message", "x\ncairn-worker: another build\n"}};
  EXPECT_EQ(Read(Pod("w-1", "Failed", Ended(refused))).why, "exit code 2: cairn-worker: another build");
  const json evicted = {{"reason", "Evicted"}, {"message", "The node was low on resource: memory."}};
  EXPECT_EQ(Read(Pod("w-1", "Failed", evicted)).why, "Evicted: The node was low on resource: memory.");
  EXPECT_EQ(Read(Pod("w-1", "Failed")).why, "it failed, and the cluster does not say why");
  EXPECT_FALSE(ReadPod(json::array(), &worker));
}

TEST(KubernetesEngine, WhatIsForgottenIsDeletedTogetherAndNotShownAgain) {
  Kubectl kubectl;
  kubectl.Has({Pod("w-1", "Failed"), Pod("w-2", "Succeeded"), Pod("w-3", "Running")});
  KubernetesEngine engine = kubectl.Engine(ThePods());
  EXPECT_EQ(engine.List().value().size(), 3U);
  EXPECT_EQ(kubectl.asked.at(0).words.at(4), "--selector=cairn-scale=w") << "no others";
  engine.Forget({"w-1"});
  engine.Forget({"w-2"});
  EXPECT_EQ(engine.List().value().size(), 1U) << "though the cluster still shows them";
  ASSERT_EQ(kubectl.asked.size(), 3U);
  const std::vector<std::string>& words = kubectl.asked[1].words;
  EXPECT_EQ(words.at(3), "pods,secrets");
  for (const char* name : {"w-1", "w-2"}) EXPECT_EQ(std::ranges::count(words, name), 1) << name;
  kubectl.Has(json::array({Pod("w-3", "Running")}));
  EXPECT_EQ(engine.List().value().size(), 1U);
  kubectl.asked.clear();
  EXPECT_EQ(engine.List().value().size(), 1U);
  EXPECT_EQ(kubectl.asked.size(), 1U) << "nothing is deleted twice";
}

TEST(KubernetesEngine, WhatIsForgottenLastGoesWithTheEngine) {
  Kubectl kubectl;
  kubectl.Engine(ThePods()).Forget({"w-1"});
  ASSERT_EQ(kubectl.asked.size(), 1U);
  EXPECT_EQ(kubectl.asked[0].words.at(2), "delete");
}

TEST(KubernetesEngine, APodThatSomebodyDeletedHasEnded) {
  Kubectl kubectl;
  kubectl.Has({Pod("w-1", "Running"), Pod("w-2", "Running")});
  KubernetesEngine engine = kubectl.Engine(ThePods());
  EXPECT_EQ(engine.List().value().size(), 2U);
  EXPECT_TRUE(engine.Stop({"w-2"}).ok());
  EXPECT_EQ(kubectl.asked.back().words,
            (std::vector<std::string>{"kubectl", "--namespace=maps", "delete", "pods", "--ignore-not-found",
                                      "--wait=false", "-o", "name", "w-2"}));
  kubectl.Has(json::array());
  for (int i = 0; i < 2; ++i) {
    const std::vector<EngineWorker> list = engine.List().value();
    ASSERT_EQ(list.size(), 2U) << "until they are forgotten";
    EXPECT_EQ(list[0].state, EngineWorker::State::kEnded);
    EXPECT_EQ(list[0].why, "its pod was deleted, not from here");
    EXPECT_EQ(list[1].why, "") << "as it was told";
  }
  engine.Forget({"w-1", "w-2"});
  EXPECT_TRUE(engine.List().value().empty());
}

TEST(KubernetesEngine, SaysWhatKubectlSaysAndWhatToDoWhereItIsMissing) {
  Kubectl kubectl;
  const std::string refused = "kubectl: The connection to the server localhost:8080 was refused";
  kubectl.answers["get"] = {{1, "", "x", refused},
                            Kubectl::Well("{\"kind\": \"List\""),
                            {-1, "", "", "kubectl: No such file or directory"}};
  KubernetesEngine engine = kubectl.Engine(ThePods());
  EXPECT_EQ(engine.List().status().message(), refused);
  EXPECT_EQ(engine.List().status().message(), "kubectl: what it shows is no list of pods");
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "install it (Debian: kubernetes-client)",
                      engine.List().status().message());
}

TEST(KubernetesEngine, AnAnswerThatIsDeeperOrMoreThanAnyListOfPodsIsNotUnpacked) {
  Kubectl kubectl;
  std::string much;
  for (int i = 0; i < 1'000'000; ++i) much += "0,";
  const std::string deep(100, '['), end(100, ']');
  for (const std::string& items : {"[" + much + "0]", deep + end, std::string("[0]")})
    kubectl.answers["get"].push_back(Kubectl::Well("{\"items\": " + items + "}"));
  KubernetesEngine engine = kubectl.Engine(ThePods());
  for (int i = 0; i < 2; ++i)
    EXPECT_EQ(engine.List().status().message(), "kubectl: what it shows is no list of pods");
  EXPECT_TRUE(engine.List().ok());
}

TEST(PodTemplate, SaysWhatATemplateLacks) {
  const auto why = [](const std::string& text) { return ReadPodTemplate(text, "t.yaml").status().message(); };
  EXPECT_EQ(why("[1, 2"), "t.yaml: line 1: not YAML: end of sequence flow not found");
  EXPECT_EQ(why("kind: Deployment"), "t.yaml: is no template of a Pod");
  EXPECT_EQ(why("text"), "t.yaml: is no template of a Pod");
  EXPECT_EQ(why("kind: Pod"), "t.yaml: has no spec");
  EXPECT_EQ(why("{kind: Pod, spec: {containers: [{name: other}]}}"), "t.yaml: has no container 'worker'");
  EXPECT_EQ(why("{kind: Pod, spec: {containers: [{name: worker}], volumes: [{name: secret}]}}"),
            "t.yaml: has no volume 'secret' of a Secret");
}

TEST(PodTemplate, WhatAPersonPutsInStays) {
  const json pod = ReadPodTemplate(R"(
kind: Pod
spec:
  nodeSelector: {disk: "1", fast: true}
  containers:
    - {name: side, image: other}
    - {name: worker, image: mine, command: [run], args: [--cache-mb, "512"], ports: [{port: 0x10}, 7, 1.5]}
  volumes: [{name: secret, secret: {secretName: x}}]
)",
                                   "t.yaml")
                       .value();
  const json made =
      MakePod(pod, {.label = "w", .image = "new", .worker = "/bin/w", .options = {"-v"}}, "w-1");
  EXPECT_EQ(made["spec"]["nodeSelector"], (json{{"disk", "1"}, {"fast", true}}));
  const json& worker = made["spec"]["containers"][1];
  EXPECT_EQ(worker["args"], (json{"--cache-mb", "512", "-v", "--name", "w-1"}));
  EXPECT_EQ(worker["command"], json{"/bin/w"});
  EXPECT_EQ(worker["image"], "new");
  EXPECT_EQ(worker["ports"], (json{{{"port", "0x10"}}, 7, 1.5}));
  EXPECT_EQ(made["spec"]["containers"][0]["image"], "other");
  EXPECT_EQ(made["spec"]["restartPolicy"], "Never");
}

}  // namespace
}  // namespace cairn::coordinator
