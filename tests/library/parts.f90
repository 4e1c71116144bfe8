! The same as parts.cpp through the Fortran module.
program parts
  use teracell
  implicit none
  type(tc_partition) :: partition, other
  character(len=1000) :: path
  integer :: rank, status

  call get_command_argument(1, path)
  call partition%read(trim(path), status)
  if (status /= tc_ok) then
    print '(a)', tc_error_text()
    error stop 1
  end if
  other = partition  ! has parts of its own
  deallocate (partition%parts)
  print '(6(i0, 1x), es24.16, 2(1x, a))', other%ranks, other%cells, other%align, other%halo, other%total, other%method, &
    other%grid_hash
  do rank = 0, int(other%ranks) - 1
    associate (part => other%parts(rank))
      print '(12(i0, 1x), es24.16, *(1x, i0))', part%lo, part%hi, part%halo_lo, part%halo_hi, part%weight, part%neighbours
    end associate
  end do
  call other%read('none.json', status)
  if (status /= tc_io .or. other%ranks /= 0 .or. allocated(other%parts)) error stop 2
end program
