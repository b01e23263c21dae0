# SPDX-License-Identifier: Apache-2.0
"""`subvol fit`: the keys of its tables, which are a contract, and the paper's figures."""

import json
import unittest

from command import InFolder, subvol


class Table1(InFolder):
    @classmethod
    def setUpClass(cls):
        done = subvol("fit", "--table1", "--json")
        assert done.code == 0, done.err
        cls.rows = done.json()["rows"]

    def test_has_the_papers_seven_rows(self):
        self.assertEqual([(row["kernel"], row["extent"]) for row in self.rows],
                         [("gaussian", None), ("bc", 1), ("bc", 2), ("bc", 3), ("cardinal", 1), ("cardinal", 2), ("cardinal", 3)])
        for row in self.rows:
            for part in ("paper", "float32", "double", "difference"):
                self.assertLessEqual({"mse", "rmse", "mae"}, set(row[part]))
        self.assertEqual(self.rows[0]["parameters"]["sigma"], 0.43)
        self.assertEqual([self.rows[2]["parameters"][key] for key in ("b", "c", "extent")], [0.039579, 0.028746, 2])
        self.assertEqual(self.rows[4]["parameters"]["a"], -0.507829)

    def test_float_sums_are_the_papers_to_its_last_digit(self):
        for row in self.rows:
            for error in ("mse", "rmse", "mae"):
                self.assertAlmostEqual(row["float32"][error], row["paper"][error], delta=1e-6)
                self.assertAlmostEqual(row["difference"][error], row["float32"][error] - row["paper"][error], delta=1e-12)

    def test_double_sums(self):
        for row, rmse in zip(self.rows, (.00640214, .00734595, .01181898, .10864744, .01128543, .01251482, .10179878)):
            self.assertAlmostEqual(row["double"]["rmse"], rmse, delta=1e-7)

    def test_the_sign_slip_explains_b_and_c(self):
        for row in self.rows[1:4]:
            for key in ("b", "c"):
                self.assertAlmostEqual(row["fitted_with_slip"]["parameters"][key], row["parameters"][key], delta=6e-4)
            self.assertLess(row["fitted"]["double"]["rmse"], row["double"]["rmse"])
        for row in self.rows[4:]:
            self.assertAlmostEqual(row["fitted"]["parameters"]["a"], row["parameters"]["a"], delta=6e-5)

    def test_people_get_a_table(self):
        lines = self.run_ok("fit", "--table1").out.splitlines()
        self.assertEqual(sum(line.startswith(("gaussian ", "bc ", "cardinal ")) for line in lines), 7)


class Kernels(InFolder):
    def test_every_kind_is_better_than_the_papers(self):
        rows = {row["kernel"]: row for row in self.run_ok("fit", "--kernels", "--json").json()["kernels"]}
        rmse = {name: row["double"]["rmse"] for name, row in rows.items()}
        order = ["paper_gaussian", "scaled_gaussian", "wendland_c2", "bc", "two_gaussians", "radial_bound", "separable_gaussian",
                 "separable_table", "tucker_2", "tucker_3", "tucker_4"]
        for worse, better in zip(order, order[1:]):
            self.assertLess(rmse[better], rmse[worse])
        self.assertEqual(rows["tucker_2"]["numbers"], 194)
        self.assertEqual(len(rows["two_gaussians"]["parameters"]["sigmas"]), 2)
        self.assertEqual(len(self.run_ok("fit", "--kernels").out.splitlines()), 1 + len(rows))

    def test_a_fitted_kernel_can_be_given_back(self):
        fitted = self.run_ok("fit", "--kernel", "bc", "--scheme", "cc", "--level", 3, "--json").json()
        self.assertEqual((fitted["scheme"], fitted["level"], fitted["kernel"]), ("cc", 3, "bc"))
        definition = fitted["definition"]
        self.assertEqual(definition["type"], "bc_spline")
        again = self.run_ok("fit", "--kernel", json.dumps(definition), "--scheme", "cc", "--level", 3, "--json").json()
        self.assertEqual(again["double"], fitted["double"])
        worse = self.run_ok("fit", "--kernel", "paper_bc", "--scheme", "cc", "--level", 3, "--json").json()
        self.assertGreater(worse["double"]["rmse"], fitted["double"]["rmse"])

    def test_a_tensor_product_spline_is_a_separable_table(self):
        fitted = self.run_ok("fit", "--kernel", "separable_table", "--scheme", "bsxw", "--level", 3, "--json").json()
        self.assertLess(fitted["double"]["max"], 1e-14)
        self.assertEqual(len(fitted["definition"]["values"]), 25)

    def test_every_name_in_the_help_works(self):
        for name in ("gaussian", "scaled_gaussian", "bc", "cardinal", "wendland_c2", "wendland_c4", "two_gaussians", "three_gaussians",
                     "gaussians", "separable_gaussian", "separable_table", "compact", "paper_bc", "cubic"):
            out = self.run_ok("fit", "--kernel", name, "--level", 2).out
            self.assertIn("RMSE", out)
            json.loads(out.splitlines()[0])


class Mistakes(InFolder):
    def assert_refused(self, *arguments, naming):
        done = subvol("fit", *arguments)
        self.assertEqual((done.code, done.out), (2, ""), done.err)
        self.assertRegex(done.err, r"^subvol: [^\n]+\n$")
        self.assertIn(naming, done.err)

    def test_one_sentence_each(self):
        self.assert_refused(naming="--table1, --kernels or --kernel NAME")
        self.assert_refused("--kernel", "sinc", naming="two_gaussians")
        self.assert_refused("--kernel", "{", naming="JSON")
        self.assert_refused("--kernel", '{"type": "gaussian", "sigma": -1}', naming="'sigma' is -1")
        self.assert_refused("--kernel", "bc", "--extent", 4, naming="extent")
        self.assert_refused("--kernel", "bc", "--level", 9, naming="--level")
        self.assert_refused("--kernel", "bc", "--scheme", "loop", naming="mcq, cc, bsxw, linear")
        self.assert_refused("--table1", "--level", 4, naming="level 5")


if __name__ == "__main__":
    unittest.main()
