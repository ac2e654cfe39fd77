#include "experiments/tuning/tuning_clock.h"

#include "common/core/error.h"
#include "common/core/files.h"
#include "experiments/text/json_file.h"

#include <nlohmann/json.hpp>

#include <chrono>

namespace gib {

double steady_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

TuningClock::TuningClock(std::string file, std::function<double()> now) : file_(std::move(file)), now_(std::move(now)) {
    try {
        const nlohmann::json stored = read_json(file_);
        for (const auto& [name, record] : stored.items())
            records_[name] = {record.at("content").get<std::string>(), record.at("seconds").get<double>(),
                              record.at("done").get<bool>(), record.at("cut").get<bool>()};
    } catch (const InputError&) {
        records_.clear();  // the first run
    } catch (const nlohmann::json::exception&) {
        records_.clear();
    }
}

void TuningClock::begin(const std::string& name, const std::string& content, bool is_stored) {
    ContentHash hash;
    hash.add(content);
    present_ = records_.try_emplace(name).first;
    if (!is_stored || present_->second.content != hash.hex()) present_->second = {.content = hash.hex()};
    started_ = now_();
    is_running_ = true;
}

void TuningClock::end(bool is_done, bool is_cut) {
    Record& record = present_->second;
    if (!record.is_done) {
        record.seconds += now_() - started_;
        record.is_done = is_done;
        record.is_cut = is_cut;
    }
    before_ += record.seconds;
    is_running_ = false;
    write();
}

double TuningClock::used() const {
    if (!is_running_) return before_;
    const Record& record = present_->second;
    return before_ + record.seconds + (record.is_done ? 0 : now_() - started_);
}

void TuningClock::write() const {
    nlohmann::json all = nlohmann::json::object();
    for (const auto& [name, record] : records_)
        all[name] = {
            {"content", record.content}, {"seconds", record.seconds}, {"done", record.is_done}, {"cut", record.is_cut}};
    write_file(file_, all.dump(1) + "\n");
}

}  // namespace gib
