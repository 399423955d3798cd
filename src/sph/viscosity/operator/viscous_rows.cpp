#include "sph/viscosity/operator/viscous_rows.hpp"

#include "mpi/exchange.hpp"

#include <algorithm>
#include <cstring>

namespace treacle::sph {

void exchange_contributions(const Comm& comm, int first, std::vector<RowContribution>& contributions) {
    const auto firsts = comm.all_gather(std::int64_t(first));
    std::vector<Message> outgoing(static_cast<std::size_t>(comm.size()));
    for (std::size_t rank = 0; rank < outgoing.size(); ++rank) outgoing[rank].rank = static_cast<int>(rank);
    std::vector<RowContribution> kept;
    for (const auto& one : contributions) {
        const auto owner = std::upper_bound(firsts.begin(), firsts.end(), std::int64_t(one.row)) - firsts.begin() - 1;
        if (static_cast<int>(owner) == comm.rank()) { // of a periodic image
            kept.push_back(one);
            continue;
        }
        auto& bytes = outgoing[static_cast<std::size_t>(owner)].bytes;
        const auto* start = reinterpret_cast<const char*>(&one);
        bytes.insert(bytes.end(), start, start + sizeof one);
    }
    std::erase_if(outgoing, [](const Message& message) { return message.bytes.empty(); });
    for (const auto& message : exchange_sparse(comm, outgoing)) {
        const auto count = message.bytes.size() / sizeof(RowContribution);
        const auto before = kept.size();
        kept.resize(before + count);
        std::memcpy(static_cast<void*>(&kept[before]), message.bytes.data(), message.bytes.size());
    }
    std::stable_sort(
        kept.begin(), kept.end(), [](const RowContribution& a, const RowContribution& b) { return a.row < b.row; });
    contributions = std::move(kept);
}

void append_row(std::vector<RowContribution>& found, solve::BlockRows& out) {
    std::stable_sort(found.begin(), found.end(),
        [](const RowContribution& a, const RowContribution& b) { return a.column < b.column; });
    for (std::size_t k = 0; k < found.size(); ++k) {
        if (k > 0 && found[k].column == found[k - 1].column) {
            for (std::size_t l = 0; l < 9; ++l) out.values[out.values.size() - 9 + l] += found[k].values[l];
            continue;
        }
        out.columns.push_back(found[k].column);
        out.values.insert(out.values.end(), found[k].values.begin(), found[k].values.end());
    }
    out.offsets.push_back(static_cast<solve::Index>(out.columns.size()));
}

} // namespace treacle::sph
