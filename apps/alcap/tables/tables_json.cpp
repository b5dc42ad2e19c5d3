// SPDX-License-Identifier: MIT
//
// tables_json.cpp: the measured tables as the keys of a report.
#include "apps/alcap/report/report.h"
#include "apps/alcap/tables/tables.h"

namespace alcap::app {
namespace {

Json to_json(const OperatorRow& row) {
  return {{"sphere", row.sphere},
          {"level", row.level},
          {"vertices", row.vertices},
          {"mean_edge", number(row.mean_edge)},
          {"connection", row.connection},
          {"kind", row.kind},
          {"l2_div", number(row.l2_div)},
          {"l2_curl", number(row.l2_curl)},
          {"linf_div", number(row.linf_div)},
          {"linf_curl", number(row.linf_curl)},
          {"face_div", number(row.face_div)},
          {"face_curl", number(row.face_curl)},
          {"energy", number(row.energy)},
          {"paper",
           {{"l2_div", number(row.paper_l2_div)},
            {"l2_curl", number(row.paper_l2_curl)},
            {"linf_div", number(row.paper_linf_div)},
            {"linf_curl", number(row.paper_linf_curl)},
            {"energy", number(row.paper_energy)}}},
          {"order",
           {{"l2_div", number(row.order_l2_div)},
            {"l2_curl", number(row.order_l2_curl)},
            {"linf_div", number(row.order_linf_div)},
            {"linf_curl", number(row.order_linf_curl)},
            {"energy", number(row.order_energy)}}}};
}

Json to_json(const StiffnessRow& row) {
  return {{"sphere", row.sphere},
          {"level", row.level},
          {"vertices", row.vertices},
          {"mean_edge", number(row.mean_edge)},
          {"connection", row.connection},
          {"energy", number(row.energy)},
          {"paper", {{"energy", number(row.paper_energy)}}},
          {"order", {{"energy", number(row.order_energy)}}}};
}

Json to_json(const EulerRow& row) {
  return {{"surface", row.surface},
          {"level", row.level},
          {"vertices", row.vertices},
          {"connection", row.connection},
          {"kind", row.kind},
          {"mean", number(row.mean)},
          {"deviation", number(row.deviation)},
          {"expected", number(row.expected)},
          {"paper", {{"mean", number(row.paper_mean)}, {"deviation", number(row.paper_deviation)}}}};
}

Json to_json(const BaselineRow& row) {
  return {{"sphere", row.sphere},       {"level", row.level},
          {"vertices", row.vertices},   {"fisher", number(row.fisher)},
          {"edge", number(row.edge)},   {"triangle", number(row.triangle)},
          {"basis", number(row.basis)}, {"crane_degrees", number(row.crane_degrees)}};
}

template <class Row>
Json rows_json(const std::vector<Row>& rows) {
  Json list = Json::array();
  for (const Row& row : rows) list.push_back(to_json(row));
  return list;
}

}  // namespace

Json tables_json(const TablesResult& result) {
  Json json;
  json["options"] = {{"levels", result.options.levels},         {"fields", result.options.fields},
                     {"harmonics", result.options.harmonics},   {"unit_harmonics", result.options.unit_harmonics},
                     {"jitter", number(result.options.jitter)}, {"seed", result.options.seed}};
  json["operators"] = rows_json(result.operators);
  json["stiffness"] = rows_json(result.stiffness);
  json["euler"] = rows_json(result.euler);
  json["baselines"] = rows_json(result.baselines);
  return json;
}

}  // namespace alcap::app
