#include "tools/evaluate/diagnosis.h"

#include <algorithm>
#include <cmath>

#include "pipeline/error_causes.h"
#include "tools/evaluate/render.h"
#include "traces/triangle_order.h"

namespace beampipe {
namespace {

const std::vector<std::pair<const char*, TriangleOrder>> kOrders = {{"given", TriangleOrder::given},
                                                                    {"shuffled", TriangleOrder::shuffled},
                                                                    {"near_to_far", TriangleOrder::near_to_far},
                                                                    {"far_to_near", TriangleOrder::far_to_near}};

double sum_of_squares(const Image& a, const Image& b) {
  double sum = 0;
  for (const float error : signed_errors(a, b)) sum += double{error} * error;
  return sum;
}

}  // namespace

CauseShares::CauseShares() {
  for (const char* cause : kErrorCauses) squares_[cause] = 0;
}

void CauseShares::add(const Technique& technique, const RunPlan& plan, std::size_t frame, SurfaceColors colors,
                      const PicturePair& pictures, std::map<std::string, std::vector<float>>& pixel_counters) {
  if (!technique.has_weights) return;
  std::vector<PixelWeights> weights;
  FrameInput run = plan.options;
  run.colors = colors;
  FrameSinks sinks = plan.sinks;
  sinks.weights = &weights;
  technique.render(plan.trace, frame, run, sinks);
  auto layers = error_causes({plan.trace, plan.trace.frames.at(frame), run, plan.sinks}, weights, pictures.image,
                             pictures.reference);
  const std::vector<float> errors = pixel_errors(pictures.image, pictures.reference);
  for (auto& [cause, layer] : layers) {
    for (std::size_t i = 0; i < errors.size(); ++i) squares_[cause] += double{layer[i]} * errors[i];
    pixel_counters["cause_" + cause] = std::move(layer);
  }
  for (const float error : errors) all_squares_ += double{error} * error;
}

std::vector<std::pair<std::string, double>> CauseShares::shares() const {
  std::vector<std::pair<std::string, double>> shares;
  if (all_squares_ == 0) return shares;
  for (const char* cause : kErrorCauses) shares.emplace_back(cause, squares_.at(cause) / all_squares_);
  return shares;
}

Json CauseShares::sums() const {
  Json squares = Json::object();
  for (const auto& [cause, sum] : squares_) squares[cause] = sum;
  return Json::array({squares, all_squares_});
}

void CauseShares::set_sums(const Json& sums) {
  for (auto& [cause, sum] : squares_) sum = sums.at(0).at(cause).get<double>();
  all_squares_ = sums.at(1).get<double>();
}

OrderComparison::OrderComparison(std::vector<Technique> techniques) : techniques_(std::move(techniques)) {
  const std::size_t orders = kOrders.size();
  sums_.assign(techniques_.size(), {std::vector<double>(orders), std::vector<double>(orders * (orders - 1) / 2)});
}

void OrderComparison::add(const Technique& reference, const RunPlan& plan, std::size_t frame, Progress& progress) {
  std::vector<std::vector<Image>> pictures(techniques_.size());
  for (std::size_t k = 0; k < kOrders.size(); ++k) {
    RunPlan ordered;
    ordered.trace = with_triangle_order(plan.trace, frame, kOrders[k].second);
    ordered.frames = {0};
    ordered.options = plan.options;
    const Image truth = render_picture(reference, ordered, 0, progress);
    for (std::size_t i = 0; i < techniques_.size(); ++i) {
      pictures[i].push_back(render_picture(techniques_[i], ordered, 0, progress));
      sums_[i].errors[k] += sum_of_squares(pictures[i].back(), truth);
    }
    if (k == 0) values_ += 3.0 * truth.width * truth.height;
  }
  for (std::size_t i = 0; i < techniques_.size(); ++i) {
    std::size_t pair = 0;
    for (std::size_t a = 0; a < kOrders.size(); ++a) {
      for (std::size_t b = a + 1; b < kOrders.size(); ++b, ++pair) {
        sums_[i].differences[pair] += sum_of_squares(pictures[i][a], pictures[i][b]);
      }
    }
  }
}

Json OrderComparison::sums() const {
  Json json = {{"values", values_}, {"techniques", Json::array()}};
  for (const Sums& sums : sums_) json["techniques"].push_back(Json::array({sums.errors, sums.differences}));
  return json;
}

void OrderComparison::set_sums(const Json& sums) {
  const auto read = [](const Json& from, std::vector<double>& to) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = from.at(i).get<double>();
  };
  values_ = sums.at("values").get<double>();
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    read(sums.at("techniques").at(i).at(0), sums_[i].errors);
    read(sums.at("techniques").at(i).at(1), sums_[i].differences);
  }
}

void OrderComparison::report(std::size_t i, TechniqueReport& report) const {
  for (std::size_t k = 0; k < sums_[i].errors.size(); ++k)
    report.orders.push_back({kOrders[k].first, std::sqrt(sums_[i].errors[k] / values_)});
  for (const double sum : sums_[i].differences)
    report.order_difference = std::max(report.order_difference, std::sqrt(sum / values_));
}

}  // namespace beampipe
