#include "optimizer/tuning_store.hpp"

#include "catalog/json_file.hpp"

namespace polyglide {
namespace {

using nlohmann::json;

constexpr const char* kTunings = "tuning";  // kind in the store
constexpr int kVersion = 1;                 // to be raised when a tuning would come out differently

json to_json(const Measures& m) {
  return {m.coverage,    m.credit, m.workspace, m.conditioning, m.worst_conditioning,
          m.compactness, m.volume, m.envelope,  m.poses};
}

Measures measures_from(const json& list) {
  return {list.at(0), list.at(1), list.at(2), list.at(3), list.at(4),
          list.at(5), list.at(6), list.at(7), list.at(8)};
}

json to_json(const Design& design) {
  return {{"values", design.values},
          {"center", {design.center.x(), design.center.y(), design.center.z()}},
          {"measures", to_json(design.measures)},
          {"score", design.score}};
}

Design design_from(const json& value) {
  const json& center = value.at("center");
  return {value.at("values"), Vector3(center.at(0), center.at(1), center.at(2)),
          measures_from(value.at("measures")), value.at("score")};
}

json to_json(const SearchSummary& search) {
  return {
      {"best", search.best},       {"value", search.value},     {"evaluations", search.evaluations},
      {"history", search.history}, {"stopped", search.stopped}, {"usable", search.usable}};
}

SearchSummary search_from(const json& value) {
  return {value.at("best"),    value.at("value"),   value.at("evaluations"),
          value.at("history"), value.at("stopped"), value.at("usable")};
}

}  // namespace

TuningStore::TuningStore(Store* store, const Brief& brief) : store_(store) {
  json what{{"version", kVersion}, {"evaluations", brief.tune_evaluations}};
  for (const char* key : {"zone", "limits", "objectives", "envelope"})
    what[key] = brief.document.value(key, json());
  brief_ = content_hash(what.dump());
}

std::optional<Tuned> TuningStore::find(const std::string& layout) const {
  if (store_ == nullptr) return std::nullopt;
  const auto text = store_->find(kTunings, key(layout));
  if (!text) return std::nullopt;
  const json value = json::parse(*text);
  return Tuned{design_from(value.at("initial")), design_from(value.at("best")),
               search_from(value.at("search")), value.at("poses")};
}

void TuningStore::put(const std::string& layout, const Tuned& tuned) const {
  if (store_ == nullptr) return;
  store_->put(kTunings, key(layout),
              json{{"initial", to_json(tuned.initial)},
                   {"best", to_json(tuned.best)},
                   {"search", to_json(tuned.search)},
                   {"poses", tuned.poses}}
                  .dump());
}

}  // namespace polyglide
