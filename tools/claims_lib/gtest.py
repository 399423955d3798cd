"""Rows that are measured by a GoogleTest program of the build folder."""

import dataclasses
import json

from .run import built, execute, launched, scratch
from .table import CommandFailed, Figure


@dataclasses.dataclass(frozen=True)
class TestReport:
    ran: int
    failed: tuple  # names of the tests that failed
    properties: dict  # what the tests recorded with RecordProperty, by key; the last value of a key stays

    @property
    def ok(self):
        return self.ran > 0 and not self.failed

    def text(self):
        recorded = "".join(f", {key} {value}" for key, value in self.properties.items())
        failures = f" (failed: {', '.join(self.failed)})" if self.failed else ""
        return f"{self.ran - len(self.failed)} of {self.ran} tests{failures}{recorded}"


STANDARD_KEYS = {"name", "file", "line", "status", "result", "timestamp", "time", "classname", "failures",
                 "value_param", "type_param"}


def run_gtest(context, program, name_filter, *, ranks=0, timeout=1800):
    """Runs the tests that the filter names; a filter that matches nothing is an error, never a pass."""
    with scratch(context, "gtest") as folder:
        report = folder / "report.json"
        binary = built(context, program, "tests")
        # Tests that take too long for the suite are disabled in it. Every rank would write the report: the variable is given through the environment so that the
        # printed command stays one that can be pasted.
        done = execute(context, launched(ranks, [binary, f"--gtest_filter={name_filter}"]), expect=None,
                       timeout=timeout, env={"GTEST_OUTPUT": f"json:{report}", "GTEST_ALSO_RUN_DISABLED_TESTS": "1"})
        if not report.exists():
            tail = " / ".join(done.output.strip().splitlines()[-3:])
            raise CommandFailed(f"{program} ended with exit code {done.code} before its report: {tail}")
        result = parse(json.loads(report.read_text()))
    if result.ran == 0:
        raise CommandFailed(f"{program} has no test {name_filter}")
    if done.code != 0 and not result.failed:
        raise CommandFailed(f"{program}: exit code {done.code}, though rank 0 saw no failure")
    return result


def gtest_on_ranks(context, program, name_filter, *, at_least):
    """The figure of tests that must pass on 1, 2, 3 and 4 ranks, no fewer of them than stated."""
    reports = {ranks: run_gtest(context, program, name_filter, ranks=ranks) for ranks in (1, 2, 3, 4)}
    ok = all(report.ok and report.ran >= at_least for report in reports.values())
    return Figure("; ".join(f"{ranks} ranks: {report.text()}" for ranks, report in reports.items()), ok)


def parse(report):
    ran, failed, properties = 0, [], {}
    for suite in report["testsuites"]:
        for case in suite["testsuite"]:
            if case["status"] != "RUN" or case.get("result") == "SKIPPED":
                continue
            ran += 1
            if case.get("failures"):
                failed.append(f"{suite['name']}.{case['name']}")
            properties.update({key: value for key, value in case.items() if key not in STANDARD_KEYS})
    return TestReport(ran, tuple(failed), properties)
