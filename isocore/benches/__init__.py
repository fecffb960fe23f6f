"""The papers' tables on the user's own data: what `isocore bench` prints."""
