"""What belongs to a release besides the package: locked versions, a bill of materials, licences."""
