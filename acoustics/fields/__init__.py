"""The kinds of sound fields that surfaces radiate into, one file each; `sound_field` says what a kind has to offer."""
