"""`python -m femstruct`: the command line where the script is not on the path."""

from femstruct.cli import main

main()
