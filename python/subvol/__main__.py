# SPDX-License-Identifier: Apache-2.0
"""`python -m subvol …` is the command `subvol …`."""
from subvol_command import main

main()
